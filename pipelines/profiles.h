// The files of configs/, built into the program by profiles.cmake.
#pragma once

#include <span>
#include <string_view>

namespace isthmus::pipelines {

struct Profile {
  std::string_view name;  ///< file name without ".yaml"
  std::string_view yaml;
};
std::span<const Profile> profiles();

}  // namespace isthmus::pipelines
