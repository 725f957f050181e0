// A survey on disk in other formats, and the poses that are found from each.
#pragma once

#include <iomanip>
#include <iostream>
#include <numbers>

#include "end_to_end/survey_on_disk.h"
#include "evaluate/inputs.h"
#include "io/cloud_writer.h"
#include "io/e57/e57_writer.h"
#include "io/ptx/ptx_writer.h"
#include "io/scan_directory.h"
#include "io/scan_writer.h"

namespace isthmus::testing {

/// All of a scan in its own frame.
inline PointChunk whole_scan(const io::ScanRef& scan) {
  auto reader = io::open_scan(scan);
  PointChunk all, chunk;
  EXPECT_TRUE(reader) << scan.path;
  while (reader && (*reader)->read(chunk, 1 << 16) && !chunk.points.empty()) {
    all.points.insert(all.points.end(), chunk.points.begin(), chunk.points.end());
    all.intensity.insert(all.intensity.end(), chunk.intensity.begin(), chunk.intensity.end());
    all.colour.insert(all.colour.end(), chunk.colour.begin(), chunk.colour.end());
  }
  return all;
}

class ConvertedSurvey : public SurveyOnDisk {
 protected:
  /// Where a national grid would put the scanner.
  const Eigen::Vector3d station_in_map_ = {512345.678, 5243210.987, 432.1};

  static std::vector<io::ScanRef> scans_in(const fs::path& folder) {
    std::vector<io::ScanRef> scans;
    const auto listing = io::list_scans({folder});
    EXPECT_TRUE(listing) << listing.error().text();
    if (listing)
      for (const io::ListedScan& scan : listing->scans) scans.push_back(scan.scan);
    return scans;
  }

  /// A file for each scan, in a format of write_scan().
  fs::path converted(const fs::path& from, const std::string& extension) {
    const fs::path to = folder_ / extension;
    fs::create_directories(to);
    for (const io::ScanRef& scan : scans_in(from)) {
      const auto written = io::write_scan(to / scan.path.filename().replace_extension(extension), whole_scan(scan), {});
      EXPECT_TRUE(written) << written.error().text();
    }
    return to;
  }

  /// All scans in one PTX file, in the order of their names, at the poses that are given, the others at identity.
  fs::path in_one_ptx(const fs::path& from, const std::vector<Transform>& poses = {}) {
    const fs::path to = folder_ / "ptx";
    fs::create_directories(to);
    auto writer = io::PtxWriter::create(to / "all.ptx");
    EXPECT_TRUE(writer);
    std::size_t num_written = 0;
    for (const io::ScanRef& scan : scans_in(from)) {
      const PointChunk points = whole_scan(scan);
      const Transform pose = num_written < poses.size() ? poses[num_written] : Transform::Identity();
      ++num_written;
      EXPECT_TRUE(writer->begin_scan(pose, !points.colour.empty()));
      EXPECT_TRUE(writer->add(points, Eigen::Vector3d::Zero()));
    }
    EXPECT_TRUE(writer->publish());
    return to;
  }

  /// LAS in steps of 0.1 mm with every station at station_in_map_, and beside them stations.csv, which says so.
  fs::path in_map_coordinates(const fs::path& from) {
    const fs::path to = folder_ / "las";
    fs::create_directories(to);
    std::ofstream stations(folder_ / "stations.csv");
    stations << "scan,x,y,z\n";
    for (const io::ScanRef& scan : scans_in(from)) {
      const fs::path file = to / scan.path.filename().replace_extension("las");
      stations << std::fixed << std::setprecision(3) << file.filename().string() << "," << station_in_map_.x() << ","
               << station_in_map_.y() << "," << station_in_map_.z() << "\n";
      auto writer = io::CloudWriter::create(file, {false, false, station_in_map_, {}});
      EXPECT_TRUE(writer);
      for (const Eigen::Vector3f& p : whole_scan(scan).points) {
        if (!p.allFinite()) continue;
        io::CloudPoint point;
        point.position = p.cast<double>() + station_in_map_;
        EXPECT_TRUE(writer->add(point));
      }
      EXPECT_TRUE(writer->publish());
    }
    return to;
  }

  /// Registers a folder into `out`; the poses in the order of the names.
  std::vector<Transform> poses_of(const fs::path& scans, const fs::path& out,
                                  const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"register", scans.string(), "-o", out.string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Said said = run(arguments);
    EXPECT_EQ(said.exit_code, 0) << said.err;
    std::vector<Transform> poses;
    const auto read = evaluate::read_poses(out / "poses.txt");
    EXPECT_TRUE(read) << read.error().text();
    if (read)
      for (const auto& [name, pose] : *read) poses.push_back(pose);
    return poses;
  }

  /// Of every pair of scans. `shift`: from the coordinates of `a`'s files to those of `b`'s.
  static void expect_same_poses(const std::vector<Transform>& a, const std::vector<Transform>& b,
                                const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) {
    constexpr double kMostMetres = 0.002, kMostDegrees = 0.02;
    ASSERT_EQ(a.size(), b.size());
    const Transform b_from_a = Transform(Eigen::Translation3d(shift));
    double metres = 0, degrees = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Transform i_from_j_by_a = a[i].inverse() * a[j];
        const Transform i_from_j_by_b = (b[i] * b_from_a).inverse() * (b[j] * b_from_a);
        const Transform off = i_from_j_by_a.inverse() * i_from_j_by_b;
        metres = std::max(metres, off.translation().norm());
        degrees = std::max(degrees, rotation_angle_rad(off.linear()) * 180 / std::numbers::pi);
      }
    std::cout << "relative poses differ by at most " << 1e3 * metres << " mm, " << degrees << " deg\n";
    EXPECT_LE(metres, kMostMetres);
    EXPECT_LE(degrees, kMostDegrees);
  }
};

}  // namespace isthmus::testing
