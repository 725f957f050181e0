// Any bytes as settings: a YAML file, and each of its lines as a value on the command line.
#include <yaml-cpp/yaml.h>

#include <cstdint>

#include "config/toy_options.h"
#include "config/yaml.h"
#include "scan/sampling.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace isthmus;
  const std::string text(reinterpret_cast<const char*>(data), size);
  config::ToyOptions toy;
  SamplingOptions sampling;
  std::vector<config::Stage> stages{config::bind(config::toy_table(), toy),
                                    config::bind(sampling_options_table(), sampling)};
  config::Origins origins;
  const auto node = config::parse_yaml(text, "fuzz.yaml");
  if (node) {
    // What it accepted can be written and read again to the same.
    if (config::apply_yaml(*node, stages, "fuzz.yaml", origins)) {
      for (config::Stage& stage : stages) {
        for (config::Option& option : stage.options) {
          const std::string before = option.text();
          const auto written = config::parse_written(before);
          if (!written || !option.assign(*written) || option.text() != before) __builtin_trap();
        }
      }
    }
  }
  const std::string line = text.substr(0, text.find('\n'));
  const std::size_t equals = line.find('=');
  if (equals != std::string::npos) {
    const auto option = config::find_option(stages, line.substr(0, equals));
    const auto written = config::parse_written(line.substr(equals + 1));
    if (option && written) (void)(*option)->assign(*written);
  }
  return 0;
}
