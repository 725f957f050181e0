// Option tables bound to a struct of options, with the struct's type forgotten: one list of stages that YAML, the
// command line, the help, the docs and the artifact keys all walk.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/error.h"
#include "config/option_table.h"

namespace isthmus::config {

/// Where an option's value lives. The struct must outlive the Option.
using Slot = std::variant<bool*, int*, double*, std::string*, std::optional<bool>*, std::optional<int>*,
                          std::optional<double>*, std::vector<std::string>*>;

/// A value as a person wrote it: one word, or a list of words.
struct Written {
  std::vector<std::string> words;
  bool is_list = false;
  bool quoted = false;  ///< "auto" in quotes is a text, auto without is the word
};

struct Option {
  std::string stage;
  std::string key;
  std::string unit;
  double min = 0;
  double max = 0;
  std::vector<std::string> choices;
  std::string help;
  std::string source;
  bool affects_results = true;
  Slot slot;
  std::string default_text;  ///< YAML text of the default

  [[nodiscard]] std::string full_key() const { return stage + "." + key; }
  /// "number", "whole number or auto", "true or false", "text", "list of texts".
  [[nodiscard]] std::string kind() const;
  /// "[0.001, 10] m", "one of auto, origin, unknown", or empty when anything of its kind is allowed.
  [[nodiscard]] std::string allowed() const;
  /// The value now as YAML text; numbers in the shortest form that reads back to the same bits.
  [[nodiscard]] std::string text() const;
  /// Sets the value; on failure it is unchanged and the error says what is allowed (without `where`).
  Result<void> assign(const Written& written);
};

struct Stage {
  std::string name;
  std::string help;
  std::vector<Option> options;
};

/// Where values came from, by full key: "survey.yaml:12", "--set", "profile street"; absent = default.
using Origins = std::map<std::string, std::string>;

/// YAML text of the value in a slot.
std::string text_of(const Slot& slot);

/// Binds a table to an instance of its options.
template <class T>
Stage bind(const OptionTable<T>& table, T& options) {
  T defaults{};
  Stage stage{table.stage, table.help, {}};
  for (const OptionRow<T>& row : table.rows) {
    const auto slot_in = [&row](T& instance) {
      return std::visit([&instance](auto member) { return Slot{&(instance.*member)}; }, row.member);
    };
    stage.options.push_back({table.stage, row.key, row.unit, row.min, row.max, row.choices, row.help, row.source,
                             row.affects_results, slot_in(options), text_of(slot_in(defaults))});
  }
  return stage;
}

/// The option with the key "stage.key", or an error that names the nearest one.
Result<Option*> find_option(std::span<Stage> stages, const std::string& full_key);

/// "key=value" as after --set; lists as [a, b] or a,b.
Result<void> apply_assignment(std::span<Stage> stages, const std::string& assignment, Origins& origins);

/// Digest (32 hex digits) of a stage's settings that affect results: keys and values, not help texts.
std::string settings_digest(const Stage& stage);

}  // namespace isthmus::config
