# Writes OUT, a C++ file with the text of every SOURCE_DIR/configs/*.yaml.
file(GLOB files ${SOURCE_DIR}/configs/*.yaml)
list(SORT files)
set(rows "")
foreach(file IN LISTS files)
  get_filename_component(name ${file} NAME_WE)
  file(READ ${file} text)
  if(NOT name STREQUAL "default")
    string(APPEND rows "    {\"${name}\", R\"yaml(${text})yaml\"},\n")
  endif()
endforeach()
list(LENGTH files count)
file(WRITE ${OUT} "// Made by pipelines/profiles.cmake.
#include \"pipelines/profiles.h\"

#include <array>

namespace isthmus::pipelines {

std::span<const Profile> profiles() {
  static constexpr auto kProfiles = std::to_array<Profile>({
${rows}  });
  return kProfiles;
}

}  // namespace isthmus::pipelines
")
