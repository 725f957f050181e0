// A stage with an option of every kind, for the tests of this folder.
#pragma once

#include "config/option.h"

namespace isthmus::config {

struct ToyOptions {
  std::optional<double> voxel_m;
  double radius = 2.5;
  int trials = 100;
  bool loops = true;
  std::string method = "fast";
  std::vector<std::string> names;
  std::optional<int> threads;
};

inline const OptionTable<ToyOptions>& toy_table() {
  static const OptionTable<ToyOptions> table{
      "toy",
      "A stage to play with.",
      {{"voxel_m", &ToyOptions::voxel_m, "m", 0.0001, 10, {}, "Edge of the voxels.", "Measured."},
       {"radius", &ToyOptions::radius, "voxels", 0, 100, {}, "A radius.", "Rusu 2009."},
       {"trials", &ToyOptions::trials, "", 1, 1000000, {}, "How often | how long.", ""},
       {"loops", &ToyOptions::loops, "", 0, 0, {}, "Whether to close loops.", ""},
       {"method", &ToyOptions::method, "", 0, 0, {"fast", "slow"}, "Which way.", ""},
       {"names", &ToyOptions::names, "", 0, 0, {}, "Names of scans.", ""},
       {"threads", &ToyOptions::threads, "", 1, 64, {}, "Threads.", "", false}}};
  return table;
}

}  // namespace isthmus::config
