// Option tables in words: the annotated default file, the explanation of one key, the tables of the docs.
#pragma once

#include <span>
#include <string>

#include "config/option.h"

namespace isthmus::config {

/// Every option with its default, unit, range, help and source as YAML comments; reads back as no change.
std::string annotated_yaml(std::span<const Stage> stages);

/// Every option with its present value, and behind it where the value came from. `indent` spaces before each line.
std::string resolved_yaml(std::span<const Stage> stages, const Origins& origins, int indent);

/// Every option with its present value and nothing else.
std::string values_yaml(std::span<const Stage> stages);

/// What one key does: for `isthmus config explain KEY`.
std::string explanation(const Option& option);

/// One section with a table for each stage, in Markdown, for docs/configuration.md.
std::string markdown_tables(std::span<const Stage> stages);

}  // namespace isthmus::config
