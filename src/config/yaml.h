// Settings from YAML: every key must be known, every value of its kind and in its range; errors name file, line,
// column.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "config/option.h"

namespace YAML {
class Node;
struct Mark;
}  // namespace YAML

namespace isthmus::config {

/// "file:line:column", counted from 1.
std::string place(const std::string& file, const YAML::Mark& mark);

/// Parses YAML text; `file` only names it in errors. yaml-cpp's exceptions end here.
Result<YAML::Node> parse_yaml(const std::string& text, const std::string& file);

/// One value written on the command line: a word or a flow list.
Result<Written> parse_written(const std::string& text);
/// The scalar or list of scalars in a node.
Result<Written> written_in(const YAML::Node& node, const std::string& file);

/// A mapping's keys in order of the file, each at most once, all known: else an error with the nearest known key.
Result<void> check_keys(const YAML::Node& mapping, std::span<const std::string> known, const std::string& file);

/// Applies a mapping of stages, {sampling: {voxel_m: 0.1}, ...}; `origin_of_line` names where a value stands.
Result<void> apply_yaml(const YAML::Node& mapping, std::span<Stage> stages, const std::string& file, Origins& origins);

}  // namespace isthmus::config
