// The scan that a person means.
#pragma once

#include <span>
#include <string>

#include "base/error.h"

namespace isthmus::pipelines {

/// Index of the scan that `wanted` names: by its name in the outputs, or by its file's name, with or without extension,
/// where that is one scan's. Else an error with the nearest name.
Result<std::size_t> index_of_scan(std::span<const std::string> names, const std::string& wanted);

}  // namespace isthmus::pipelines
