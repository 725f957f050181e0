// A made-up survey with everything a report may have to show.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "report/survey_record.h"
#include "survey/synthetic_survey.h"

namespace isthmus::testing {

/// Stations on a loop of streets; every 9th link wrong, some ambiguous, the last two scans apart, one file unreadable.
inline report::SurveyRecord sample_record(int num_scans) {
  World world(num_scans, 21);
  for (int i = 0; i < num_scans; ++i) {
    const double angle = 6.283 * i / (num_scans - 2), radius = 40 + 10 * std::sin(3 * angle);
    Transform pose = Transform::Identity();
    pose.linear() = rotation_from_vector({0, 0, world.rng.uniform(-3, 3)});
    pose.translation() =
        Eigen::Vector3d(1.5 * radius * std::cos(angle), radius * std::sin(angle), world.rng.uniform(-1, 1));
    world.world_from_local[i] = pose;
    world.graph.scans[i].name = fmt::format("street/station_{:03}.ply", i);
    world.graph.scans[i].centre.setZero();
  }
  const int ring = num_scans - 2;
  for (int i = 0; i < ring; ++i) {
    for (int step = 1; step <= 3; ++step) {
      const int j = (i + step) % ring;
      const auto [low, high] = std::minmax(i, j);
      const double probability = 1.0 - 0.25 * world.rng.uniform() * world.rng.uniform();
      const double overlap = 0.55 / step * world.rng.uniform(0.6, 1.0);
      Link& link = (i + step) % 9 == 0   ? world.wrong(high, low, 0.6, Verdict::rejected)
                   : (i + step) % 7 == 0 ? world.shifted(high, low, 1.0, 0.6, Verdict::ambiguous)
                                         : world.right(high, low, probability);
      link.result.overlap = link.result.overlap_of_source = overlap;
      link.result.overlap_of_target = overlap * 1.2;
      link.result.rms_m = kVoxel * world.rng.uniform(0.05, 0.45);
      if (link.result.verdict != Verdict::accepted)
        link.result.reason = "a rival pose 1.0 m away explains the points as well";
      link.result.evidence = {{"support", overlap},
                              {"contradiction", 0.01},
                              {"observability", world.rng.uniform(0.02, 0.9)},
                              {"share_under_6mm", world.rng.uniform(0.2, 0.7)},
                              {"share_under_20mm", world.rng.uniform(0.7, 1.0)}};
      link.result.seconds_by_stage = {{"hypotheses", 0.2}, {"refine", 0.1}};
    }
  }
  world.shifted(ring, 0, 0.0, 0.4, Verdict::ambiguous).result.reason = "slides along the facade";
  world.wrong(num_scans - 1, 3, 0.1, Verdict::rejected).result.reason = "contradicted by free space";
  report::SurveyRecord record;
  record.title = "Old town <quarter>";
  record.voxel_m = kVoxel;
  record.solution = solve(world.graph, {});
  for (const GraphScan& scan : world.graph.scans) {
    report::ScanRecord s;
    s.id = scan.id;
    s.name = scan.name;
    s.format = "ply";
    s.points = 21000 + 100 * scan.id;
    s.num_read = 4800000;
    s.voxel_m = kVoxel;
    s.spacing_m = 0.012;
    s.station_kind = StationKind::origin;
    s.radius_m = 15;
    s.seconds = {{"read", 1.2}, {"describe", 2.5}};
    record.scans.push_back(s);
  }
  report::ScanRecord broken;
  broken.id = num_scans;
  broken.name = "street/station_%20broken.ply";
  broken.reason =
      "station_ broken.ply, byte 1034: the file ends inside the vertices, \"4800000\" were promised (copy it again)";
  record.scans.push_back(broken);
  record.settings_yaml = "sampling:\n  voxel_m: 0.1   # from the scans\n";
  record.versions = {{"isthmus", "0.1.0"}, {"ceres", "2.1.0"}};
  record.warnings = {"two files share the stem station_004: the PLY was taken"};
  record.run.command = "isthmus register street -o out";
  record.run.started = "2025-01-01T12:00:00Z";
  record.run.threads = 2;
  record.run.seconds = 83;
  record.run.peak_memory_bytes = 812ULL << 20;
  report::judge_scans(record);
  return record;
}

}  // namespace isthmus::testing
