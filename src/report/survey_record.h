// Everything the outputs say about one survey, in one plain struct: what a pipeline fills and the writers read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report/view_cloud.h"
#include "scan/sampled_scan.h"
#include "survey/pose_graph.h"

namespace isthmus::report {

enum class ScanStatus : std::uint8_t {
  placed,    ///< in a component of two or more scans
  unplaced,  ///< read, but no accepted link holds it
  failed,    ///< could not be read or reduced
};

using Seconds = std::vector<std::pair<std::string, double>>;  ///< by stage, in the order of work

struct ScanRecord {
  int id = 0;        ///< vertex id
  std::string name;  ///< io::ScanRef::name
  ScanStatus status = ScanStatus::failed;
  std::string reason = "not computed";  ///< why it failed or is unplaced; empty when placed
  std::string format;                   ///< "ply", ...
  std::uint64_t points = 0;             ///< after voxel sampling
  std::uint64_t num_read = 0;
  std::uint64_t num_dropped = 0;
  double voxel_m = 0;
  double spacing_m = 0;
  StationKind station_kind = StationKind::unknown;
  Eigen::Vector3d station = Eigen::Vector3d::Zero();  ///< local frame; meaningful unless unknown
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< centroid of the points, local frame
  double radius_m = 0;
  Eigen::Vector3d local_origin_in_scan = Eigen::Vector3d::Zero();
  std::vector<std::string> notes;
  Seconds seconds;
  ViewCloud view;  ///< for the 3D view; may be empty

  template <class F>
  void fields(F&& f) {
    f(id), f(name), f(status), f(reason), f(format), f(points), f(num_read), f(num_dropped), f(voxel_m), f(spacing_m);
    f(station_kind), f(station), f(centre), f(radius_m), f(local_origin_in_scan), f(notes), f(seconds);
  }
};

/// What differs from run to run: never in a deterministic output.
struct RunRecord {
  std::string command;
  std::string started;  ///< ISO 8601, UTC
  std::string host;
  std::string input;
  std::string output;
  std::string store;
  int threads = 0;
  double seconds = 0;
  std::uint64_t peak_memory_bytes = 0;
  int exit_code = 0;
  std::vector<std::string> warnings;  ///< those that this run alone had: damaged products, a full disk
  std::vector<std::pair<std::string, std::string>> more;  ///< name, value
};

struct SurveyRecord {
  std::string title;  ///< the input folder's name, for the report
  double voxel_m = 0;
  std::vector<ScanRecord> scans;                              ///< ascending ids, failed ones too
  Solution solution;                                          ///< every pair tried is in solution.links
  std::string settings_yaml;                                  ///< as used
  std::vector<std::pair<std::string, std::string>> versions;  ///< name, version; isthmus first
  std::vector<std::string> warnings;
  std::string no_view;  ///< why report.html does not show the scans in space; empty if it does
  RunRecord run;
};

/// Fills status and reason of every scan from the solution; unplaced ones learn which link came nearest to holding
/// them. A scan that the solution does not know has failed and keeps the reason the caller gave it.
void judge_scans(SurveyRecord& record);

const char* word(ScanStatus status);  ///< "placed", "unplaced", "failed"
const char* word(Verdict verdict);    ///< as in links.csv: "accepted", "ambiguous", "rejected", "failed"
const char* word(StationKind kind);   ///< "unknown", "origin", "estimated"
const char* word(ByHand by_hand);     ///< "", "taken out", "added"

const ScanRecord* find_scan(const SurveyRecord& record, int id);

/// The id's component, or nullopt for failed scans.
std::optional<int> component_of(const SurveyRecord& record, int id);

/// Pose of a placed scan in its own file's coordinates: component_from_scan = (anchor's local origin) *
/// component_from_local *
/// (-local origin). The component's frame is the anchor's scan frame, so the anchor has the identity.
Transform component_from_scan(const SurveyRecord& record, int id);

/// A link's measurement between the scan frames of its files.
Transform target_from_source_in_scans(const SurveyRecord& record, const Link& link);

/// Its information for a right perturbation in the source's scan frame: d_scan = Ad(local origin) d_local.
Matrix6d information_in_scan(const Matrix6d& information, const Eigen::Vector3d& local_origin_in_scan);

/// A term of the pair's evidence, if it was weighed.
std::optional<double> evidence_term(const PairResult& result, std::string_view name);

/// The most probable tried link between this scan's component and any other, accepted ones excluded.
const SolvedLink* best_open_link(const SurveyRecord& record, int component);

}  // namespace isthmus::report
