// make_fuzz_seeds FOLDER: files for the fuzzers to begin with, FOLDER/TARGET/seeds/*, from a simulated scan in every
// format that is read, in its variants.
#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "features/feature_cloud.h"
#include "io/e57_testing.h"
#include "io/ptx/ptx_writer.h"
#include "io/scan_writer.h"
#include "pairwise/pair_result.h"
#include "regions/region_map.h"
#include "scan/sampled_scan.h"
#include "simulate/simulate.h"
#include "store/archive.h"
#include "store/sample.h"

namespace {

namespace fs = std::filesystem;
using isthmus::PointChunk;
using isthmus::io::testing::bytes_of_value;

fs::path root;

void seed(const std::string& target, const std::string& name, const std::string& bytes) {
  const fs::path folder = root / target / "seeds";
  fs::create_directories(folder);
  std::ofstream(folder / name, std::ios::binary) << bytes;
}

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

[[noreturn]] void give_up(const std::string& why) {
  fmt::print(stderr, "make_fuzz_seeds: {}\n", why);
  std::exit(1);
}

/// Points spread over a simulated scan of an office, with colours made of their heights.
PointChunk simulated_points() {
  constexpr std::size_t kPoints = 60;  // small seeds are mutated fastest
  isthmus::SimulateOptions options;
  options.stations = 1;
  options.resolution_deg = 2;
  options.output = (root / "simulated").string();
  const auto simulated = isthmus::simulate(options);
  if (!simulated) give_up(simulated.error().text());
  auto points = isthmus::io::probe_scan({root / "simulated" / simulated->scans.at(0).name, 0, {}}, kPoints);
  if (!points) give_up(points.error().text());
  for (const auto& p : points->points) {
    const auto shade = static_cast<std::uint8_t>(std::min(std::abs(p.z()) * 50.0F, 255.0F));
    points->colour.push_back({shade, 100, 7});
  }
  return *points;
}

void seeds_by_our_writers(const PointChunk& points) {
  PointChunk bare;
  bare.points = points.points;
  isthmus::io::WriteOptions far;
  far.local_origin_in_scan = {4.5e6, 5e5, 100};
  isthmus::io::WriteOptions posed;
  posed.file_from_scan = isthmus::Transform(Eigen::Translation3d(1, 2, 3));
  for (const std::string extension : {"ply", "pcd", "xyz", "e57"}) {
    const fs::path path = root / ("written." + extension);
    int k = 0;
    const auto keep = [&](const PointChunk& chunk, const isthmus::io::WriteOptions& options) {
      if (const auto written = isthmus::io::write_scan(path, chunk, options); !written) give_up(written.error().text());
      const std::string bytes = slurp(path);
      const std::string name = fmt::format("written_{}.{}", k++, extension);
      // The fuzz target of E57 puts the checksums back, unless the last byte is 1.
      seed(extension, name, extension == "e57" ? isthmus::io::testing::unpaged(bytes) : bytes);
      if (extension == "e57") seed(extension, "paged_" + name, bytes + '\1');
    };
    keep(points, {});
    keep(bare, {});
    keep(points, far);
    keep(points, posed);
  }
  const fs::path path = root / "written.ptx";
  auto ptx = isthmus::io::PtxWriter::create(path);
  for (const bool colour : {true, false}) {
    if (!ptx || !ptx->begin_scan(*posed.file_from_scan, colour) || !ptx->add(points, {0, 0, 0})) give_up("ptx");
  }
  if (!ptx->publish()) give_up("ptx");
  seed("ptx", "written.ptx", slurp(path));
}

/// Each point as a line of the format, counted from `first`.
template <class Line>
std::string lines(const PointChunk& points, const Line& line) {
  std::string text;
  for (std::size_t i = 0; i < points.points.size(); ++i) text += line(points.points[i], points.intensity[i]);
  return text;
}

void seeds_as_text(const PointChunk& points) {
  const auto xyz =
      lines(points, [](const auto& p, float) { return fmt::format("{:.3f} {:.3f} {:.3f}\n", p.x(), p.y(), p.z()); });
  const auto num = points.points.size();
  seed("xyz", "bare.txt", xyz);
  seed("xyz", "header.csv", "x,y,z,intensity\n" + lines(points, [](const auto& p, float i) {
                              return fmt::format("{},{},{},{}\n", p.x(), p.y(), p.z(), i);
                            }));
  seed("xyz", "quoted.csv",
       "\"X\";\"Y\";\"Z\";\"Red\";\"Green\";\"Blue\"\r\n" + lines(points, [](const auto& p, float) {
         return fmt::format("{:.2e};{};{};1;2;255\r\n", p.x(), p.y(), p.z());
       }));
  seed("pts", "counted.pts", fmt::format("{}\n", num) + lines(points, [](const auto& p, float) {
                               return fmt::format("{} {} {} -120 1 2 3\n", p.x(), p.y(), p.z());
                             }));
  seed("pts", "bare.pts", fmt::format("{}\n{}", num, xyz));
  seed("3dtk", "bare.3d", xyz);
  seed("3dtk", "reflectance.3d", lines(points, [](const auto& p, float i) {
         return fmt::format("{:.1f} {:.1f} {:.1f} {}\n", 100 * p.x(), 100 * p.y(), 100 * p.z(), i);
       }));
  seed("obj", "mesh.obj", "# office\no room\n" + lines(points, [](const auto& p, float) {
                            return fmt::format("v {} {} {} 0.5 0.25 1\n", p.x(), p.y(), p.z());
                          }) + "vn 0 0 1\nf 1 2 3\nf 1//1 2//1 3//1\n");
  seed("ply", "ascii.ply",
       fmt::format("ply\nformat ascii 1.0\ncomment office\nelement vertex {}\nproperty float x\n"
                   "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                   "end_header\n{}3 0 1 2\n",
                   num, xyz));
  seed("pcd", "ascii.pcd",
       fmt::format("# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {}\n"
                   "HEIGHT 1\nVIEWPOINT 0 0 1 1 0 0 0\nPOINTS {}\nDATA ascii\n{}",
                   num, num, xyz));
  std::string ptx = fmt::format("{}\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 6 7 1\n", num / 2);
  ptx += lines(points,
               [](const auto& p, float) { return fmt::format("{:.4f} {:.4f} {:.4f} 0.25\n", p.x(), p.y(), p.z()); });
  seed("ptx", "grid.ptx", ptx.replace(ptx.rfind("\n", ptx.size() - 2), std::string::npos, "\n0 0 0 0.5\n"));
}

void seeds_as_bytes(const PointChunk& points) {
  std::string little, big, with_lists, columns;
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      little += bytes_of_value(points.points[i][axis]);
      big += bytes_of_value(static_cast<double>(points.points[i][axis]), true);
      with_lists += bytes_of_value(points.points[i][axis]);
    }
    with_lists += std::string("\2\7\0\1\0", 5);
    little += bytes_of_value(points.intensity[i]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    for (const auto& p : points.points) columns += bytes_of_value(p[axis]);
  }
  seed("kitti", "scan.bin", little);
  const auto num = points.points.size();
  const auto ply = [&](const std::string& form, const std::string& type, const std::string& more) {
    return fmt::format(
        "ply\nformat {} 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\nproperty {} z\n{}end_header\n", form, num,
        type, type, type, more);
  };
  seed("ply", "big.ply", ply("binary_big_endian", "double", "") + big);
  seed("ply", "lists.ply", ply("binary_little_endian", "float", "property list uchar short marks\n") + with_lists);
  // LZF of literals only: a byte of (length - 1) before up to 32 bytes.
  std::string packed;
  constexpr std::size_t kLiterals = 32;
  for (std::size_t at = 0; at < columns.size(); at += kLiterals) {
    const std::string piece = columns.substr(at, kLiterals);
    packed += static_cast<char>(piece.size() - 1) + piece;
  }
  seed("pcd", "compressed.pcd",
       fmt::format("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {}\nHEIGHT 1\nPOINTS {}\nDATA "
                   "binary_compressed\n",
                   num, num) +
           bytes_of_value(static_cast<std::uint32_t>(packed.size())) +
           bytes_of_value(static_cast<std::uint32_t>(columns.size())) + packed);
}

/// LAS 1.2 and 1.4 with the fields that are read: sizes, scales, offsets, count.
void seeds_as_las(const PointChunk& points) {
  struct Kind {
    std::uint8_t minor, format;
    std::size_t header_bytes, record_bytes;
  };
  for (const Kind& kind : {Kind{2, 0, 227, 20}, Kind{2, 3, 227, 34}, Kind{4, 6, 375, 30}, Kind{4, 7, 375, 36}}) {
    std::string header(kind.header_bytes, '\0');
    const auto put = [](std::string& bytes, std::size_t at, const auto& value) {
      bytes.replace(at, sizeof value, bytes_of_value(value));
    };
    header.replace(0, 4, "LASF");
    put(header, 24, std::uint8_t{1});
    put(header, 25, kind.minor);
    put(header, 94, static_cast<std::uint16_t>(kind.header_bytes));
    put(header, 96, static_cast<std::uint32_t>(kind.header_bytes));
    put(header, 104, kind.format);
    put(header, 105, static_cast<std::uint16_t>(kind.record_bytes));
    put(header, 107, static_cast<std::uint32_t>(points.points.size()));
    if (kind.minor == 4) put(header, 247, static_cast<std::uint64_t>(points.points.size()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      put(header, 131 + 8 * axis, 0.001);
      put(header, 155 + 8 * axis, 1000.0);
    }
    for (const auto& p : points.points) {
      std::string record(kind.record_bytes, '\1');
      for (int axis = 0; axis < 3; ++axis) {
        put(record, 4 * static_cast<std::size_t>(axis), static_cast<std::int32_t>(1000 * p[axis]));
      }
      header += record;
    }
    seed("las", fmt::format("format_{}.las", kind.format), header);
  }
}

void seeds_of_the_store(const PointChunk& points) {
  using isthmus::store::to_bytes;
  isthmus::SampledScan sampled;
  sampled.points = points.points;
  sampled.normals.assign(points.points.size(), Eigen::Vector3f::UnitZ());
  isthmus::FeatureCloud features;
  for (std::uint32_t i = 0; i < points.points.size(); i += 3) features.keypoints.push_back(i);
  isthmus::RegionMap regions;
  regions.regions.resize(2);
  isthmus::PairResult pair;
  pair.target_from_source = isthmus::Transform::Identity();
  pair.evidence = {{"overlap", 0.5}};
  const std::string sample = to_bytes(isthmus::store::full_sample());
  seed("products", "sampled", "s" + to_bytes(sampled));
  seed("products", "features", "f" + to_bytes(features));
  seed("products", "regions", "r" + to_bytes(regions));
  seed("products", "pair", "p" + to_bytes(pair));
  seed("products", "sample", "x" + sample);
  const auto text = [](const std::string& s) { return bytes_of_value(static_cast<std::uint64_t>(s.size())) + s; };
  seed("artifact", "sample",
       "isthmusA" + bytes_of_value(std::uint32_t{1}) + text("sample/00112233445566778899aabbccddeeff") + text(sample));
  seed("journal", "run.tsv",
       "1700000000.5\trun\t\t\tregister scans\t0\n1700000001.5\tbegan\tpair\t00ff\ta - b\t0\n"
       "1700000002\tmade\tpair\t00ff\ta - b\t0.25\n1700000003\tended\t\t\t0\t2.5\n");
}

void seeds_of_settings() {
  seed("settings", "full.yaml",
       "# a survey\ntoy:\n  voxel_m: 0.25\n  radius: 3\n  loops: false\n  method: slow\n"
       "  names: [a, \"b,c\"]\n  threads: auto\nsampling: {target_points: 200000, voxel_m: auto}\n");
  seed("settings", "anchors.yaml", "toy: &a {names: [\"auto\", 'x', !!str y]}\n---\n? toy\n: *a\n");
  seed("settings", "assignment", "toy.names=[a, b]\n");
  seed("settings", "number", "toy.voxel_m=1e-3\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) give_up("one argument: the folder");
  root = argv[1];
  fs::remove_all(root);
  fs::create_directories(root);
  const PointChunk points = simulated_points();
  seeds_by_our_writers(points);
  seeds_as_text(points);
  seeds_as_bytes(points);
  seeds_as_las(points);
  seeds_of_the_store(points);
  seeds_of_settings();
  return 0;
}
