#include "io/wording.h"

#include <fmt/format.h>

namespace isthmus::io {

std::string at_line(std::string_view file, std::uint64_t line) { return fmt::format("{}, line {}", file, line); }

std::string at_byte(std::string_view file, std::uint64_t offset) { return fmt::format("{}, byte {}", file, offset); }

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::string out = "'";
  for (const char c : text.substr(0, kLongest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x20 && byte < 0x7F) {
      out += c;
    } else {
      out += fmt::format("\\x{:02x}", byte);
    }
  }
  if (text.size() > kLongest) out += "...";
  return out + "'";
}

std::string lower_case(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

}  // namespace isthmus::io
