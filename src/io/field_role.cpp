#include "io/field_role.h"

#include <array>
#include <string>
#include <utility>

#include "io/wording.h"

namespace isthmus::io {
namespace {

// Names seen in files of CloudCompare, PDAL, PCL, MeshLab, Open3D, ParaView and in surveyors' tables.
constexpr std::array<std::pair<std::string_view, FieldRole>, 37> kNames = {{
    {"x", FieldRole::x},
    {"east", FieldRole::x},
    {"easting", FieldRole::x},
    {"points:0", FieldRole::x},
    {"points_0", FieldRole::x},
    {"y", FieldRole::y},
    {"north", FieldRole::y},
    {"northing", FieldRole::y},
    {"points:1", FieldRole::y},
    {"points_1", FieldRole::y},
    {"z", FieldRole::z},
    {"height", FieldRole::z},
    {"elevation", FieldRole::z},
    {"points:2", FieldRole::z},
    {"points_2", FieldRole::z},
    {"intensity", FieldRole::intensity},
    {"scalar_intensity", FieldRole::intensity},
    {"scalar_scalar_intensity", FieldRole::intensity},
    {"reflectance", FieldRole::intensity},
    {"scalar_reflectance", FieldRole::intensity},
    {"reflectivity", FieldRole::intensity},
    {"amplitude", FieldRole::intensity},
    {"i", FieldRole::intensity},
    {"red", FieldRole::red},
    {"r", FieldRole::red},
    {"diffuse_red", FieldRole::red},
    {"rf", FieldRole::red},
    {"green", FieldRole::green},
    {"g", FieldRole::green},
    {"diffuse_green", FieldRole::green},
    {"gf", FieldRole::green},
    {"blue", FieldRole::blue},
    {"b", FieldRole::blue},
    {"diffuse_blue", FieldRole::blue},
    {"bf", FieldRole::blue},
    {"rgb", FieldRole::packed_rgb},
    {"rgba", FieldRole::packed_rgb},
}};

}  // namespace

FieldRole role_of_field(std::string_view name) {
  const std::string_view around = " \t\r\"'";
  const auto first = name.find_first_not_of(around);
  if (first == std::string_view::npos) return FieldRole::other;
  const std::string lower = lower_case(name.substr(first, name.find_last_not_of(around) - first + 1));
  for (const auto& [known, role] : kNames) {
    if (known == lower) return role;
  }
  return FieldRole::other;
}

}  // namespace isthmus::io
