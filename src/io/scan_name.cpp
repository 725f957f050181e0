#include "io/scan_name.h"

#include <fmt/format.h>

#include <charconv>

namespace isthmus::io {

std::string scan_name(const std::filesystem::path& relative_path, std::optional<int> index) {
  std::string name;
  for (const char c : relative_path.generic_string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte <= 0x20 || byte == 0x7F || c == '#' || c == '%') {
      name += fmt::format("%{:02X}", byte);
    } else {
      name += c;
    }
  }
  if (index) name += fmt::format("#{}", *index);
  return name;
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    if (text[i] == '%' && i + 2 < text.size()) {
      const char* const digits = text.data() + i + 1;
      if (std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
        out += static_cast<char>(byte);
        i += 2;
        continue;
      }
    }
    out += text[i];
  }
  return out;
}

}  // namespace isthmus::io
