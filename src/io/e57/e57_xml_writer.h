// Building the nodes of an E57 file's XML section with pugixml; for the sources of this folder only.
#pragma once

#include <pugixml.hpp>
#include <string>

#include "base/digest.h"
#include "geometry/transform.h"

namespace isthmus::io {

pugi::xml_node append_e57_node(pugi::xml_node parent, const char* name, const char* type);
void append_e57_string(pugi::xml_node parent, const char* name, const std::string& text);
void append_e57_integer(pugi::xml_node parent, const char* name, std::int64_t value);
void append_e57_float(pugi::xml_node parent, const char* name, double value);

/// Replaces the node's pose, or adds one.
void set_e57_pose(pugi::xml_node parent, const Transform& pose);

/// "{8-4-4-4-12}" digits from 32.
std::string e57_guid(const Digest& digest);

std::string e57_xml_text(const pugi::xml_document& document, bool as_it_is);

}  // namespace isthmus::io
