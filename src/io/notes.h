// Notes of a reading: which are a matter of course, and which tell of something odd in the file.
#pragma once

#include <string_view>

namespace isthmus::io {

// How the notes begin or end that every sound file of its kind gets.
inline constexpr std::string_view kLasNote = "LAS ";
inline constexpr std::string_view kGridNote = "grid of ";
inline constexpr std::string_view kByNamesNote = " by their names";
inline constexpr std::string_view kByValuesNote = " by their values";
inline constexpr std::string_view kNoReturnNote = " no-return lines (0 0 0) left out";

/// Whether the note only says how the file was read. All others belong among a run's warnings.
inline bool is_matter_of_course(std::string_view note) {
  return note.starts_with(kLasNote) || note.starts_with(kGridNote) || note.ends_with(kByNamesNote) ||
         note.ends_with(kByValuesNote) || note.ends_with(kNoReturnNote);
}

}  // namespace isthmus::io
