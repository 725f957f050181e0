// What a named column of a file means to us; one list of names for PLY, PCD and text headers.
#pragma once

#include <cstdint>
#include <string_view>

namespace isthmus::io {

enum class FieldRole : std::uint8_t { other, x, y, z, intensity, red, green, blue, packed_rgb };

/// Case does not matter; quotes and blanks around the name are ignored. Unknown names are FieldRole::other.
FieldRole role_of_field(std::string_view name);

}  // namespace isthmus::io
