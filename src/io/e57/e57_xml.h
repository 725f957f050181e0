// Reading the nodes of an E57 file's XML section with pugixml; for the sources of this folder only.
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::io {

/// Parses into `document`, with all that is needed to write it back if `keep_all`; fails with the place in the XML.
Result<void> parse_e57_xml(const std::string& xml, const std::string& file, bool keep_all,
                           pugi::xml_document& document);

/// The text in a node: all pieces of it, also those in CDATA.
std::string e57_text(const pugi::xml_node& node);

/// The number in an Integer, ScaledInteger or Float node; an empty node is 0, as the format has it. Nothing if the node
/// is missing or holds no number.
std::optional<double> e57_number(const pugi::xml_node& node);

/// The pose in a node of type Structure: rotation w x y z and translation x y z; a missing part is identity, a missing
/// node or a quaternion that is not of unit length is no pose.
std::optional<Transform> e57_pose(const pugi::xml_node& pose);

}  // namespace isthmus::io
