// A survey's outputs against ground truth: edge precision, recall by overlap, pose errors.
//
// Definitions (the same as the independent surveyeval.py): the overlap of two scans is the share of one's voxel-sampled
// points with a point of the other within 1.5 voxels that faces the same way, the smaller of both directions. A link is
// right when it is within 2 degrees and 2 evaluation voxels of the truth at the source's centroid. Pose errors are
// measured at the scan's origin, each component in the gauge of the anchor that gives the smallest median error.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "geometry/transform.h"

namespace isthmus::evaluate {

struct EvaluateOptions {
  std::filesystem::path truth;  ///< "name r00 r01 r02 tx ... tz", scan -> common frame
  std::optional<std::filesystem::path>
      overlaps;  ///< first line "# voxel V", then "name name overlap"; absent: computed
  std::optional<double>
      voxel_m;                  ///< evaluation voxel; absent: the overlap file's, or else the run's own from scans.csv
  double max_deg = 1.0;         ///< a pose is good within this
  std::optional<double> max_m;  ///< and this; absent: two evaluation voxels
};

struct WrongEdge {
  std::string target;
  std::string source;
  std::optional<double> rotation_deg;  ///< absent: not in the truth
  double translation_m = 0;            ///< at the source's centroid
  std::optional<double> overlap;
};

struct Band {
  std::string name;  ///< ">30%", "20-30%", "10-20%", "5-10%", "<5%"
  int found = 0;     ///< pairs with a right link
  int pairs = 0;
};

struct PoseScore {
  int placed = 0;               ///< in components of two or more, and in the truth
  int of = 0;                   ///< scans in the truth
  int within = 0;               ///< within max_deg and max_m
  std::vector<int> components;  ///< their sizes
  double median_deg = 0, median_m = 0, max_deg = 0, max_m = 0;
};

struct Evaluation {
  double voxel_m = 0;
  int edges = 0;
  int right = 0;
  int placeable = 0;  ///< size of the largest part connected by pairs above 10 % overlap
  std::vector<WrongEdge> wrong;
  std::vector<Band> bands;  ///< most overlap first; bands without pairs are left out
  std::optional<PoseScore> poses;
  std::vector<std::string> unknown_placed;  ///< placed scans that the truth does not know
};

/// Reads scans.csv, pose_graph.g2o and poses.txt of `out_dir` and the scans that it needs from `scans_dir`.
Result<Evaluation> evaluate(const std::filesystem::path& out_dir, const std::filesystem::path& scans_dir,
                            const EvaluateOptions& options);

/// The truth file of a folder of scans, by custom: poses.gt.txt, poses_refined.txt or poses.txt, the first that exists.
std::optional<std::filesystem::path> truth_beside(const std::filesystem::path& scans_dir);

std::string text_of(const Evaluation& evaluation);
std::string json_of(const Evaluation& evaluation);

}  // namespace isthmus::evaluate
