// How fast files are read, one core, from the page cache. Files are written to a temporary folder first.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "e57_testing.h"
#include "io/cloud_writer.h"
#include "io/ptx/ptx_writer.h"
#include "io/scan_reader.h"
#include "io/scan_writer.h"

namespace isthmus::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kPoints = 2000000;

PointChunk some_points() {
  PointChunk points;
  std::uint32_t state = 7;
  const auto next = [&] { return static_cast<float>((state = state * 1664525U + 1013904223U) >> 8) * 5e-6F - 40.0F; };
  for (std::size_t i = 0; i < kPoints; ++i) {
    points.points.emplace_back(next(), next(), next());
    points.intensity.push_back(next());
  }
  return points;
}

template <class T>
void put(std::string& bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

// LAS 1.2, point format 0.
void write_las(const fs::path& path, const PointChunk& points) {
  constexpr double kScale = 0.001;
  std::string bytes(227, '\0');
  bytes.replace(0, 4, "LASF");
  put<std::uint8_t>(bytes, 24, 1);
  put<std::uint8_t>(bytes, 25, 2);
  put<std::uint16_t>(bytes, 94, 227);
  put<std::uint32_t>(bytes, 96, 227);
  put<std::uint16_t>(bytes, 105, 20);
  put(bytes, 107, static_cast<std::uint32_t>(points.points.size()));
  for (std::size_t axis = 0; axis < 3; ++axis) put(bytes, 131 + 8 * axis, kScale);
  for (const auto& p : points.points) {
    std::string record(20, '\0');
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(record, 4 * axis, static_cast<std::int32_t>(std::lround(p[static_cast<Eigen::Index>(axis)] / kScale)));
    }
    bytes += record;
  }
  std::ofstream(path, std::ios::binary) << bytes;
}

// What scanners write: 22 bits of a tenth of a millimetre an axis, whether the point is valid, 12 bits of intensity.
void write_e57_integers(const fs::path& path, const PointChunk& points) {
  constexpr double kScale = 0.0001;
  constexpr std::int64_t kLimit = (1 << 21) - 1;
  std::string prototype, packets;
  for (const std::string& axis : testing::kXyz) {
    prototype +=
        testing::field_xml(axis, R"(type="ScaledInteger" minimum="-2097151" maximum="2097151" scale="0.0001")");
  }
  prototype += testing::field_xml("cartesianInvalidState", R"(type="Integer" minimum="0" maximum="2")") +
               testing::field_xml("intensity", R"(type="Integer" minimum="0" maximum="4095")");
  constexpr std::size_t kPerPacket = 6000;
  for (std::size_t begin = 0; begin < points.points.size(); begin += kPerPacket) {
    std::array<std::vector<std::uint64_t>, 5> stored;
    for (std::size_t i = begin; i < std::min(points.points.size(), begin + kPerPacket); ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const double value = points.points[i][static_cast<Eigen::Index>(axis)];
        stored[axis].push_back(static_cast<std::uint64_t>(std::llround(value / kScale) + kLimit));
      }
      stored[3].push_back(0);
      stored[4].push_back(i % 4096);
    }
    packets += testing::data_packet({testing::packed(stored[0], 22), testing::packed(stored[1], 22),
                                     testing::packed(stored[2], 22), testing::packed(stored[3], 2),
                                     testing::packed(stored[4], 12)});
  }
  testing::HandMadeE57 e57;
  e57.add_scan(points.points.size(), prototype, packets);
  std::ofstream(path, std::ios::binary) << e57.file();
}

// LAS 1.4, point format 6, compressed: points lie as they come from a scanner, side by side on surfaces, for LASzip's
// speed depends on them.
void write_laz(const fs::path& path) {
  CloudShape shape;
  shape.intensity = true;
  auto writer = CloudWriter::create(path, shape);
  if (!writer) std::abort();
  constexpr std::size_t kColumn = 1000;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double azimuth = 6.283 * static_cast<double>(i / kColumn) * kColumn / kPoints;
    const double height = 0.003 * static_cast<double>(i % kColumn);
    const double range = 10 + 2 * std::sin(7 * azimuth) + 0.002 * std::sin(static_cast<double>(i * i % 1009));
    CloudPoint point;
    point.position = {range * std::cos(azimuth), range * std::sin(azimuth), height};
    point.intensity = static_cast<float>(1000 + i * i % 31);
    if (!writer->add(point)) std::abort();
  }
  if (!writer->publish()) std::abort();
}

void write_ptx(const fs::path& path, const PointChunk& points) {
  auto writer = PtxWriter::create(path);
  if (!writer || !writer->begin_scan(Transform::Identity(), false) || !writer->add(points, Eigen::Vector3d::Zero()) ||
      !writer->publish())
    std::abort();
}

/// The files, in a folder that goes away with the program.
struct Files {
  fs::path folder;
  Files() {
    std::string pattern = (fs::temp_directory_path() / "isthmus_bench_XXXXXX").string();
    folder = ::mkdtemp(pattern.data());
    const PointChunk points = some_points();
    for (const char* name : {"a.ply", "a.pcd", "a.e57", "a.xyz"}) {
      if (!write_scan(folder / name, points)) std::abort();
    }
    write_las(folder / "a.las", points);
    if (has_laz()) write_laz(folder / "a.laz");
    write_ptx(folder / "a.ptx", points);
    write_e57_integers(folder / "integers.e57", points);
    std::ofstream(folder / "a.pts") << kPoints << "\n" << std::ifstream(folder / "a.xyz").rdbuf();
  }
  ~Files() { fs::remove_all(folder); }
};

void read_all(benchmark::State& state, const char* name) {
  static const Files files;
  const fs::path path = files.folder / name;
  if (!fs::exists(path)) {
    state.SkipWithError("not in this build");
    return;
  }
  for (auto _ : state) {
    auto reader = open_scan({path, 0, {}});
    std::size_t points = 0;
    for (PointChunk chunk; reader;) {
      if (!(*reader)->read(chunk, 65536) || chunk.points.empty()) break;
      points += chunk.points.size();
    }
    if (points != kPoints) state.SkipWithError("not all points were read");
  }
  state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * fs::file_size(path)));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * kPoints));
}

void probe(benchmark::State& state, const char* name) {
  static const Files files;
  for (auto _ : state) {
    auto points = probe_scan({files.folder / name, 0, {}}, 20000);
    if (!points || points->points.size() < 19000) state.SkipWithError("too few points probed");
  }
}

BENCHMARK_CAPTURE(read_all, ply, "a.ply")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, pcd, "a.pcd")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, las, "a.las")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, laz, "a.laz")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, e57, "a.e57")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, e57_integers, "integers.e57")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, xyz, "a.xyz")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, ptx, "a.ptx")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_all, pts, "a.pts")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(probe, ply, "a.ply")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(probe, e57, "a.e57")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(probe, xyz, "a.xyz")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace isthmus::io
