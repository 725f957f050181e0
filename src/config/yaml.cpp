#include "config/yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>

#include "config/nearest_word.h"

namespace isthmus::config {
namespace {

Result<void> apply_stage(const YAML::Node& mapping, Stage& stage, const std::string& file, Origins& origins) {
  if (mapping.IsNull()) return {};  // an empty section: every value keeps its default
  std::vector<std::string> keys;
  for (const Option& option : stage.options) keys.push_back(option.key);
  if (const Result<void> known = check_keys(mapping, keys, file); !known) return known;
  for (const auto& entry : mapping) {
    const std::string key = entry.first.Scalar();
    Option& option = *std::ranges::find(stage.options, key, &Option::key);
    if (entry.second.IsNull()) {
      return fail(fmt::format("{} has no value", option.full_key()), place(file, entry.first.Mark()),
                  "write a value or auto");
    }
    const Result<Written> written = written_in(entry.second, file);
    if (!written) return tl::unexpected(written.error());
    if (Result<void> done = option.assign(*written); !done) {
      done.error().where = place(file, entry.second.Mark());
      return done;
    }
    origins[option.full_key()] = fmt::format("{}:{}", file, entry.first.Mark().line + 1);
  }
  return {};
}

}  // namespace

std::string place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
}

Result<YAML::Node> parse_yaml(const std::string& text, const std::string& file) {
  try {
    return YAML::Load(text);
  } catch (const YAML::Exception& error) {
    return fail(error.msg, place(file, error.mark), "this is no valid YAML");
  }
}

Result<Written> written_in(const YAML::Node& node, const std::string& file) {
  Written written;
  if (node.IsScalar()) {
    written.words.push_back(node.Scalar());
    written.quoted = node.Tag() == "!";
    return written;
  }
  if (!node.IsSequence()) return fail("a value is missing here", place(file, node.Mark()), "write a value or auto");
  written.is_list = true;
  for (const auto& item : node) {
    if (!item.IsScalar()) return fail("a list of plain values is expected", place(file, item.Mark()));
    written.words.push_back(item.Scalar());
  }
  return written;
}

Result<Written> parse_written(const std::string& text) {
  if (text.empty()) return Written{{""}, false, true};
  const Result<YAML::Node> node = parse_yaml(text, "");
  if (!node) return tl::unexpected(node.error());
  return written_in(*node, "");
}

Result<void> check_keys(const YAML::Node& mapping, std::span<const std::string> known, const std::string& file) {
  if (!mapping.IsMap()) return fail("a mapping (key: value) is expected", place(file, mapping.Mark()));
  std::set<std::string> seen;
  for (const auto& entry : mapping) {
    if (!entry.first.IsScalar()) return fail("a key must be a word", place(file, entry.first.Mark()));
    const std::string key = entry.first.Scalar();
    if (!seen.insert(key).second)
      return fail(fmt::format("key '{}' is given twice", key), place(file, entry.first.Mark()));
    if (std::ranges::find(known, key) != known.end()) continue;
    const std::string nearest = nearest_word(key, known);
    return fail(fmt::format("unknown key '{}'", key), place(file, entry.first.Mark()),
                nearest.empty() ? fmt::format("known here: {}", fmt::join(known, ", "))
                                : fmt::format("did you mean {}?", nearest));
  }
  return {};
}

Result<void> apply_yaml(const YAML::Node& mapping, std::span<Stage> stages, const std::string& file, Origins& origins) {
  if (mapping.IsNull()) return {};  // an empty file: nothing differs from the defaults
  std::vector<std::string> names;
  for (const Stage& stage : stages) names.push_back(stage.name);
  if (const Result<void> known = check_keys(mapping, names, file); !known) return known;
  for (const auto& entry : mapping) {
    Stage& stage = *std::ranges::find(stages, entry.first.Scalar(), &Stage::name);
    if (const Result<void> done = apply_stage(entry.second, stage, file, origins); !done) return done;
  }
  return {};
}

}  // namespace isthmus::config
