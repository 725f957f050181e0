#include "config/option.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/digest.h"
#include "config/nearest_word.h"
#include "config/yaml.h"

namespace isthmus::config {
namespace {

constexpr const char* kAutomatic = "auto";

template <class T>
constexpr const char* kKind = "";
template <>
constexpr const char* kKind<bool> = "true or false";
template <>
constexpr const char* kKind<int> = "whole number";
template <>
constexpr const char* kKind<double> = "number";
template <>
constexpr const char* kKind<std::string> = "text";
template <>
constexpr const char* kKind<std::vector<std::string>> = "list of texts";
template <class T>
constexpr const char* kKind<std::optional<T>> = kKind<T>;

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

bool is_number(const Slot& slot) {
  return std::visit(
      []<class T>(const T*) {
        return std::is_same_v<T, int> || std::is_same_v<T, double> || std::is_same_v<T, std::optional<int>> ||
               std::is_same_v<T, std::optional<double>>;
      },
      slot);
}

/// Words that YAML would read as something else, and texts with special letters, go into double quotes.
std::string yaml_text(const std::string& word) {
  static const std::string kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./%+";
  const bool plain = !word.empty() && word.find_first_not_of(kPlain) == std::string::npos && word[0] != '-' &&
                     word != "null" && word != "~";
  if (plain) return word;
  std::string out = "\"";
  for (const char c : word) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\n') {
      out += "\\n";
    } else {
      out += c;
    }
  }
  return out + "\"";
}

std::string text_of_value(bool value) { return value ? "true" : "false"; }
std::string text_of_value(int value) { return fmt::format("{}", value); }
std::string text_of_value(double value) { return fmt::format("{}", value); }
std::string text_of_value(const std::string& value) { return yaml_text(value); }
std::string text_of_value(const std::vector<std::string>& value) {
  std::vector<std::string> words;
  for (const std::string& word : value) words.push_back(yaml_text(word));
  return fmt::format("[{}]", fmt::join(words, ", "));
}
template <class T>
std::string text_of_value(const std::optional<T>& value) {
  return value ? text_of_value(*value) : kAutomatic;
}

/// A number must use up the whole word.
template <class T>
Result<T> parse_number(const Option& option, const std::string& word) {
  T value{};
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(word.data(), end, value);
  if (error != std::errc() || stop != end) {
    return fail(fmt::format("{} = {} is no {}", option.full_key(), word, kKind<T>), "", "expected " + option.kind());
  }
  const auto number = static_cast<double>(value);
  if (!std::isfinite(number) || number < option.min || number > option.max) {
    return fail(fmt::format("{} = {} is out of range", option.full_key(), word), "", "allowed: " + option.allowed());
  }
  return value;
}

Result<std::string> parse_text(const Option& option, const std::string& word) {
  if (option.choices.empty() || std::ranges::find(option.choices, word) != option.choices.end()) return word;
  const std::string nearest = nearest_word(word, option.choices);
  return fail(fmt::format("{} = {} is not {}", option.full_key(), word, option.allowed()), "",
              nearest.empty() ? "" : fmt::format("did you mean {}?", nearest));
}

Result<void> parse_into(const Option& option, const Written& written, bool& out) {
  if (written.words[0] != "true" && written.words[0] != "false") {
    return fail(fmt::format("{} = {} is neither true nor false", option.full_key(), written.words[0]));
  }
  out = written.words[0] == "true";
  return {};
}

template <class T>
requires std::is_same_v<T, int> || std::is_same_v<T, double> Result<void> parse_into(const Option& option,
                                                                                     const Written& written, T& out) {
  const Result<T> value = parse_number<T>(option, written.words[0]);
  if (!value) return tl::unexpected(value.error());
  out = *value;
  return {};
}

Result<void> parse_into(const Option& option, const Written& written, std::string& out) {
  const Result<std::string> value = parse_text(option, written.words[0]);
  if (!value) return tl::unexpected(value.error());
  out = *value;
  return {};
}

Result<void> parse_into(const Option& option, const Written& written, std::vector<std::string>& out) {
  std::vector<std::string> words;
  for (const std::string& word : written.words) {
    const Result<std::string> value = parse_text(option, word);
    if (!value) return tl::unexpected(value.error());
    words.push_back(*value);
  }
  out = words;
  return {};
}

template <class T>
Result<void> parse_into(const Option& option, const Written& written, std::optional<T>& out) {
  if (!written.quoted && written.words[0] == kAutomatic) {
    out.reset();
    return {};
  }
  T value{};
  const Result<void> parsed = parse_into(option, written, value);
  if (parsed) out = value;
  return parsed;
}

}  // namespace

std::string text_of(const Slot& slot) {
  return std::visit([](const auto* value) { return text_of_value(*value); }, slot);
}

std::string Option::text() const { return text_of(slot); }

std::string Option::kind() const {
  return std::visit([]<class T>(const T*) { return std::string(kKind<T>) + (IsOptional<T>::value ? " or auto" : ""); },
                    slot);
}

std::string Option::allowed() const {
  if (!choices.empty()) return fmt::format("one of {}", fmt::join(choices, ", "));
  if (!is_number(slot) || (!std::isfinite(min) && !std::isfinite(max))) return "";
  const std::string suffix = unit.empty() ? "" : " " + unit;
  if (!std::isfinite(max)) return fmt::format("at least {}{}", min, suffix);
  if (!std::isfinite(min)) return fmt::format("at most {}{}", max, suffix);
  return fmt::format("{} to {}{}", min, max, suffix);
}

Result<void> Option::assign(const Written& written) {
  const bool wants_list = std::holds_alternative<std::vector<std::string>*>(slot);
  if (written.is_list && !wants_list) {
    return fail(fmt::format("{} is a {}, not a list", full_key(), kind()));
  }
  if (!written.is_list && written.words.size() != 1) return fail(fmt::format("{} has no value", full_key()));
  return std::visit([&](auto* value) { return parse_into(*this, written, *value); }, slot);
}

Result<Option*> find_option(std::span<Stage> stages, const std::string& full_key) {
  std::vector<std::string> keys;
  for (Stage& stage : stages) {
    for (Option& option : stage.options) {
      if (option.full_key() == full_key) return &option;
      keys.push_back(option.full_key());
    }
  }
  const std::string nearest = nearest_word(full_key, keys);
  return fail(fmt::format("unknown key '{}'", full_key), "",
              nearest.empty() ? "'isthmus config default' lists all keys" : fmt::format("did you mean {}?", nearest));
}

Result<void> apply_assignment(std::span<Stage> stages, const std::string& assignment, Origins& origins) {
  const auto in_set = [&](Error error) {
    error.where = "--set " + assignment;
    return tl::unexpected(error);
  };
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) return in_set({"no '=' in it", "", "write --set stage.key=value"});
  const Result<Option*> option = find_option(stages, assignment.substr(0, equals));
  if (!option) return in_set(option.error());
  Result<Written> written = parse_written(assignment.substr(equals + 1));
  if (!written) return in_set(written.error());
  if (const Result<void> done = (*option)->assign(*written); !done) return in_set(done.error());
  origins[(*option)->full_key()] = "--set";
  return {};
}

std::string settings_digest(const Stage& stage) {
  Digest digest;
  digest.add(stage.name);
  for (const Option& option : stage.options) {
    if (option.affects_results) digest.add(option.key).add(option.text());
  }
  return digest.hex();
}

}  // namespace isthmus::config
