// Helpers of the io tests: files in a folder of their own, whole scans read in small chunks.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/scan_reader.h"

namespace isthmus::io::testing {

/// A fresh folder per test, removed afterwards.
class IoTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "isthmus_io_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    const auto path = folder / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }

  std::filesystem::path folder;
};

/// A whole scan, its points back in the scan's frame.
struct WholeScan {
  ScanHeader header;
  std::vector<Eigen::Vector3d> p_in_scan;
  PointChunk chunk;  ///< all chunks one after the other, local frame
};

/// Reads a scan in chunks of `chunk_points` (small, so that chunk borders are met).
inline Result<WholeScan> read_whole(const ScanRef& scan, std::size_t chunk_points = 7) {
  auto reader = open_scan(scan);
  if (!reader) return tl::unexpected(reader.error());
  WholeScan whole;
  for (PointChunk chunk;;) {
    auto done = (*reader)->read(chunk, chunk_points);
    if (!done) return tl::unexpected(done.error());
    if (chunk.points.empty()) break;
    EXPECT_LE(chunk.points.size(), chunk_points);
    EXPECT_TRUE(chunk.intensity.empty() || chunk.intensity.size() == chunk.points.size());
    EXPECT_TRUE(chunk.colour.empty() || chunk.colour.size() == chunk.points.size());
    whole.chunk.points.insert(whole.chunk.points.end(), chunk.points.begin(), chunk.points.end());
    whole.chunk.intensity.insert(whole.chunk.intensity.end(), chunk.intensity.begin(), chunk.intensity.end());
    whole.chunk.colour.insert(whole.chunk.colour.end(), chunk.colour.begin(), chunk.colour.end());
  }
  whole.header = (*reader)->header();
  for (const auto& p : whole.chunk.points) {
    whole.p_in_scan.push_back(p.cast<double>() + whole.header.local_origin_in_scan);
  }
  return whole;
}
inline Result<WholeScan> read_whole(const std::filesystem::path& path) { return read_whole(ScanRef{path, 0, {}}); }

/// The error's text, or a text that says there was none.
template <class T>
std::string error_of(const Result<T>& result) {
  return result ? "no error" : result.error().text();
}

/// A value's bytes, little endian unless `big`.
template <class T>
std::string bytes_of_value(T value, bool big = false) {
  std::string raw(sizeof(T), '\0');
  std::memcpy(raw.data(), &value, sizeof(T));
  return big ? std::string(raw.rbegin(), raw.rend()) : raw;
}

inline void expect_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double tolerance) {
  EXPECT_LE((a - b).cwiseAbs().maxCoeff(), tolerance) << a.transpose() << " against " << b.transpose();
}

}  // namespace isthmus::io::testing
