// Numbers in text, fast (std::from_chars) and independent of the locale.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace isthmus::io {

inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

inline const char* skip_blanks(const char* place, const char* end) {
  while (place != end && is_blank(*place)) ++place;
  return place;
}

inline std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Parses a number at `place` (no blanks before it; a leading '+', nan and inf are numbers); the place behind it, or
/// nullptr if there is none. The caller checks what follows.
inline const char* parse_number(const char* place, const char* end, double& value) {
  if (place != end && *place == '+') ++place;
  const auto [behind, error] = std::from_chars(place, end, value);
  return error == std::errc() ? behind : nullptr;
}

/// The whole text as one number; nothing if anything else is in it.
template <class T>
std::optional<T> whole_number(std::string_view text) {
  T value{};
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  const auto [behind, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || behind != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Words separated by blanks.
inline std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  const char* place = line.data();
  const char* const end = place + line.size();
  while ((place = skip_blanks(place, end)) != end) {
    const char* const first = place;
    while (place != end && !is_blank(*place)) ++place;
    words.emplace_back(first, static_cast<std::size_t>(place - first));
  }
  return words;
}

}  // namespace isthmus::io
