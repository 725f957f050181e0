// "Did you mean ...?" for misspelt keys and words.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace isthmus::config {

/// Number of single-letter edits (insert, delete, change, swap of neighbours) that turn `a` into `b`
/// (Damerau-Levenshtein, optimal string alignment), letters compared without case.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The word nearest to `word`, the first of equals; empty when none is closer than half of the longer one's length.
std::string nearest_word(std::string_view word, std::span<const std::string> words);

}  // namespace isthmus::config
