#include "regions/options.h"

#include "regions/divisions.h"

namespace isthmus {
namespace {

std::vector<std::string> names_of_divisions() {
  std::vector<std::string> names;
  for (const Division& division : divisions()) names.emplace_back(division.name);
  return names;
}

std::string help_of_divisions() {
  std::string help = "How keypoints are divided";
  const char* separator = ": ";
  for (const Division& division : divisions()) {
    help.append(separator).append(division.name).append(" = ").append(division.help);
    separator = "; ";
  }
  return help + ".";
}

}  // namespace

const config::OptionTable<RegionOptions>& region_options_table() {
  using O = RegionOptions;
  static const config::OptionTable<O> table{
      "regions",
      "Division of a scan's keypoints into feature regions.",
      {
          {"division", &O::division, "", 0, 0, names_of_divisions(), help_of_divisions(), "docs/stages/regions.md"},
          {"keypoints_per_region",
           &O::keypoints_per_region,
           "",
           5,
           10000,
           {},
           "Keypoints that a region should hold. Smaller regions find smaller overlaps and cost more votes.",
           "docs/stages/regions.md"},
          {"planes_angle_deg",
           &O::planes_angle_deg,
           "deg",
           1,
           60,
           {},
           "Division by planes: how far a point's normal may turn from that of its patch.",
           "normals of flat surfaces scatter by a few degrees, corners turn by tens; docs/stages/regions.md"},
          {"planes_distance_voxels",
           &O::planes_distance_voxels,
           "voxels",
           0.05,
           10,
           {},
           "Division by planes: how far a point may lie off its patch.",
           "the centroid of a voxel lies off the surface by its noise, less than half an edge"},
          {"spectral_neighbours",
           &O::spectral_neighbours,
           "",
           2,
           100,
           {},
           "Spectral division: nearest keypoints that each keypoint is tied to.",
           "on a surface a point has about eight neighbours around it; docs/stages/regions.md"},
          {"differences_angle_deg",
           &O::differences_angle_deg,
           "deg",
           0.5,
           60,
           {},
           "Division by differences: angle between neighbouring normals where a boundary begins.",
           "a crease of a right angle is rounded to steps of some 20 degrees a voxel; docs/stages/regions.md"},
          {"differences_variation",
           &O::differences_variation,
           "",
           0.0005,
           0.33,
           {},
           "Division by differences: step in surface variation between neighbouring points where a boundary begins.",
           "flat surfaces stay below 0.01, creases rise beyond 0.05; docs/stages/regions.md"},
      }};
  return table;
}

}  // namespace isthmus
