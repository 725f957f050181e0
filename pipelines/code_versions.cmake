# Writes OUT, a header with a digest of the sources that decide each stored product, so that no product of other code is
# ever taken from a store. A changed comment makes products anew as well: cheap, next to a wrong result.
function(code_digest variable)
  set(all "")
  foreach(module IN LISTS ARGN)
    file(GLOB_RECURSE files ${SOURCE_DIR}/src/${module}/*.h ${SOURCE_DIR}/src/${module}/*.cpp)
    list(SORT files)
    foreach(file IN LISTS files)
      file(SHA256 ${file} digest)
      file(RELATIVE_PATH name ${SOURCE_DIR} ${file})
      string(APPEND all "${name} ${digest}\n")
    endforeach()
  endforeach()
  string(SHA256 digest "${all}")
  string(SUBSTRING ${digest} 0 16 digest)
  set(${variable} ${digest} PARENT_SCOPE)
endfunction()

set(reading base geometry scan io)
code_digest(sampled ${reading})
code_digest(features ${reading} features)
code_digest(regions ${reading} features regions)
code_digest(pair ${reading} features regions congruent pairwise)
set(text "// Made by pipelines/code_versions.cmake: digests of the sources behind each stored product.
#pragma once

namespace isthmus::pipelines {

inline constexpr const char* kSampledVersion = \"${sampled}\";
inline constexpr const char* kFeaturesVersion = \"${features}\";
inline constexpr const char* kRegionsVersion = \"${regions}\";
inline constexpr const char* kPairVersion = \"${pair}\";

}  // namespace isthmus::pipelines
")
set(old "")
if(EXISTS ${OUT})
  file(READ ${OUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUT} "${text}")
endif()
