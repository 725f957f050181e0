// Limits of numbers on the command line, in words: CLI11's own checks print the largest double in full.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "io/text_number.h"

namespace isthmus::cli {

/// What is no number at all is for CLI11 to say.
inline CLI::Validator above_zero() {
  return {[](const std::string& text) -> std::string {
            const auto number = io::whole_number<double>(text);
            return number && !(*number > 0) ? text + " is not above 0" : "";
          },
          "ABOVE 0"};
}

inline CLI::Validator not_negative() {
  return {[](const std::string& text) -> std::string {
            const auto number = io::whole_number<double>(text);
            return number && !(*number >= 0) ? text + " is below 0" : "";
          },
          "FROM 0"};
}

}  // namespace isthmus::cli
