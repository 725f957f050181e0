// One truth per option: a stage's options are a plain struct, and beside it one table that names each member's key,
// unit, range, help text and source. YAML, command line, help, docs and artifact keys are all made from that table.
//
//   struct SamplingOptions { std::optional<double> voxel_m; bool dropouts = true; };
//   const config::OptionTable<SamplingOptions>& sampling_options_table();
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace isthmus::config {

/// A pointer to the member that an option sets. std::optional means "automatic when absent" (YAML: auto).
template <class T>
using Member = std::variant<bool T::*, int T::*, double T::*, std::string T::*, std::optional<bool> T::*,
                            std::optional<int> T::*, std::optional<double> T::*, std::vector<std::string> T::*>;

template <class T>
struct OptionRow {
  std::string key;  ///< within the stage: "voxel_m"
  Member<T> member;
  std::string unit;                                       ///< "m", "deg", "voxels", "" for counts, names and ratios
  double min = -std::numeric_limits<double>::infinity();  ///< smallest allowed number, inclusive
  double max = std::numeric_limits<double>::infinity();   ///< largest allowed number, inclusive
  std::vector<std::string> choices;                       ///< allowed words; empty = any
  std::string help;                                       ///< one or two sentences for a surveyor
  std::string source;           ///< why this default: a paper, a sensor fact, a benchmark page in docs
  bool affects_results = true;  ///< false: threads, memory, logging; left out of artifact keys
};

template <class T>
struct OptionTable {
  std::string stage;  ///< YAML section: "sampling"
  std::string help;   ///< one sentence
  std::vector<OptionRow<T>> rows;
};

}  // namespace isthmus::config
