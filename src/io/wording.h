// The words errors are made of: places in files, and bytes a person can read.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace isthmus::io {

/// "<file>, line <line>" (lines count from 1).
std::string at_line(std::string_view file, std::uint64_t line);

/// "<file>, byte <offset>" (bytes count from 0).
std::string at_byte(std::string_view file, std::uint64_t offset);

/// `text` in quotes for an error message: at most 60 bytes, control bytes and broken bytes as \xNN.
std::string in_quotes(std::string_view text);

/// ASCII lower case; other bytes stay.
std::string lower_case(std::string_view text);

}  // namespace isthmus::io
