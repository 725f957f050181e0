// A stand-alone driver for the simulator: SCENE -o DIR [--key value]... with the keys of the option table.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "simulate/simulate.h"

namespace {

using isthmus::SimulateOptions;

bool set_option(SimulateOptions& o, const std::string& key, const std::string& value) {
  for (const auto& row : isthmus::simulate_options_table().rows) {
    if (row.key != key && row.key != key + "_deg" && row.key != key + "_m") continue;
    std::visit(
        [&](auto member) {
          auto& target = o.*member;
          using T = std::decay_t<decltype(target)>;
          if constexpr (std::is_same_v<T, bool> || std::is_same_v<T, std::optional<bool>>) target = value == "true";
          if constexpr (std::is_same_v<T, int>) target = std::atoi(value.c_str());
          if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>)
            target = std::atof(value.c_str());
          if constexpr (std::is_same_v<T, std::string>) target = value;
        },
        row.member);
    return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2 || argc % 2 != 0) {
    fmt::print(stderr, "usage: isthmus_simulate_cli SCENE -o DIR [--key value]...\n");
    return 2;
  }
  SimulateOptions options;
  options.scene = argv[1];
  for (int k = 2; k + 1 < argc; k += 2) {
    const std::string flag = argv[k];
    const std::string key = flag == "-o" ? "output" : flag.substr(flag.find_first_not_of('-'));
    if (!set_option(options, key, argv[k + 1])) {
      fmt::print(stderr, "unknown option {}\n", flag);
      return 2;
    }
  }
  const auto start = std::chrono::steady_clock::now();
  const auto summary =
      isthmus::simulate(options, [](const isthmus::SimulatedScan& scan, std::size_t done, std::size_t total) {
        fmt::print(stderr, "{}/{} {} {} points of {} rays\n", done, total, scan.name, scan.num_points, scan.num_rays);
      });
  if (!summary) {
    fmt::print(stderr, "{}\n", summary.error().text());
    return 1;
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  double rays = 0;
  for (const auto& scan : summary->scans) rays += static_cast<double>(scan.num_rays);
  fmt::print(stderr, "{} triangles, {:.1f} s, {:.2f} million rays a second\n", summary->num_triangles, seconds,
             rays / seconds / 1e6);
  return 0;
}
