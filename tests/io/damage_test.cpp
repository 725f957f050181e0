// Damaged files: any bytes give points or an error, soon, without a crash (run under the sanitizers too).
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "base/rng.h"
#include "e57_testing.h"
#include "io/cloud_writer.h"
#include "io/inspect.h"
#include "io/scan_directory.h"
#include "io/scan_writer.h"
#include "io_testing.h"
#include "shared_data.h"

namespace isthmus::io::testing {
namespace {

namespace fs = std::filesystem;

std::string slurp(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// A few bytes changed, a piece cut out, doubled, or the end cut off.
std::string damaged(std::string bytes, Rng& rng) {
  const std::string digits = "0123456789-+.eE \n\xFF";
  const std::size_t changes = 1 + rng.below(6);
  for (std::size_t c = 0; c < changes && !bytes.empty(); ++c) {
    const bool in_header = rng.below(2) == 0;
    const std::size_t at = rng.below(in_header ? std::min<std::size_t>(bytes.size(), 400) : bytes.size());
    const std::size_t length = std::min<std::size_t>(bytes.size() - at, 1 + rng.below(20));
    switch (rng.below(6)) {
      case 0:
        bytes[at] = static_cast<char>(rng.below(256));
        break;
      case 1:
        bytes[at] = digits[rng.below(digits.size())];
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, length));
        break;
      case 4:
        bytes.insert(at, "99999999999");
        break;
      default:
        bytes.resize(at);
    }
  }
  return bytes;
}

void read_in_every_way(const fs::path& path) {
  const auto scans = scans_of_file(path);
  if (!scans) return;
  for (const ScanRef& scan : *scans) {
    const auto whole = read_whole(scan, 1000);
    EXPECT_TRUE(whole || !whole.error().what.empty());
    EXPECT_TRUE(!whole || whole->p_in_scan.size() <= fs::file_size(path) * 88);
    const auto probe = probe_scan(scan, 100);
    EXPECT_TRUE(!probe || probe->points.size() <= 100U);
    const auto summary = inspect_scan(scan);
    EXPECT_EQ(summary.has_value(), whole.has_value());
  }
}

class Damage : public IoTest {
 protected:
  void damage_often(const fs::path& good, int times) {
    const std::string bytes = slurp(good);
    ASSERT_FALSE(bytes.empty());
    Rng rng(seed_of(1, good.filename().string()));
    const fs::path path = folder / ("damaged" + good.extension().string());
    for (int i = 0; i < times; ++i) {
      fs::remove(path);  // writing over it would wait for the disk each time
      std::ofstream(path, std::ios::binary) << damaged(bytes, rng);
      read_in_every_way(path);
      if (HasFailure()) {
        fs::copy_file(path, fs::temp_directory_path() / ("isthmus_damaged" + good.extension().string()),
                      fs::copy_options::overwrite_existing);
        FAIL() << good << " damaged for the " << i << "th time; the file is kept in the temporary folder";
      }
    }
  }
};

TEST_F(Damage, FilesOfOurOwnNeverCrash) {
  PointChunk points;
  Rng rng(5);
  for (int i = 0; i < 40; ++i) {
    points.points.emplace_back(static_cast<float>(rng.uniform()), 2.0F, static_cast<float>(i));
    points.intensity.push_back(static_cast<float>(i));
    points.colour.push_back({1, 2, 3});
  }
  for (const char* name : {"a.ply", "a.pcd", "a.xyz", "a.e57"}) {
    ASSERT_TRUE(write_scan(folder / name, points));
    damage_often(folder / name, 400);
  }
  const char* const cloud = has_laz() ? "a.laz" : "a.las";
  auto writer = CloudWriter::create(folder / cloud, {true, true, Eigen::Vector3d::Zero(), {}});
  ASSERT_TRUE(writer);
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(writer->add({{rng.uniform(), 2.0, 1.0 * i}, 3.0F, {1, 2, 3}, 4}));
  ASSERT_TRUE(writer->publish());
  damage_often(folder / cloud, 400);
  damage_often(write("a.bin", std::string(160, '\x3F')), 50);
  damage_often(write("a.3d", "1 2 3\n4 5 6\n7 8 9\n"), 100);
}

// With right checksums over wrong bytes: what the checksums would keep from the code behind them.
TEST_F(Damage, E57WithRightChecksumsNeverCrashes) {
  std::vector<std::string> good;
  HandMadeE57 e57;
  const auto axis = [](const std::string& name, const std::string& limits) {
    return field_xml(name, R"(type="ScaledInteger" scale="0.01" )" + limits);
  };
  const std::string prototype = axis("cartesianX", R"(minimum="0" maximum="999")") +
                                axis("cartesianY", R"(minimum="5" maximum="5")") +
                                field_xml("cartesianZ", R"(type="Float" precision="single")") +
                                field_xml("cartesianInvalidState", R"(type="Integer" minimum="0" maximum="2")") +
                                axis("intensity", "") + field_xml("note", R"(type="String")");
  std::vector<std::uint64_t> x;
  for (std::uint64_t i = 0; i < 50; ++i) x.push_back(i);
  const std::string packet = data_packet({packed(x, 10).substr(0, 40),
                                          {},
                                          raw_bytes(std::vector<float>(50, 2.0F)),
                                          packed(std::vector<std::uint64_t>(50, 0), 2),
                                          packed(x, 64),
                                          "text"}) +
                             other_packet('\0', 16) + data_packet({packed(x, 10).substr(40), {}, {}, {}, {}, {}});
  for (int k = 0; k < 2; ++k) e57.add_scan(50, prototype, packet);
  good.push_back(unpaged(e57.file()));
  PointChunk points;
  for (int i = 0; i < 200; ++i) points.points.emplace_back(1.0F, 2.0F, static_cast<float>(i));
  ASSERT_TRUE(write_scan(folder / "a.e57", points));
  good.push_back(unpaged(slurp(folder / "a.e57")));
  Rng rng(17);
  for (const std::string& logical : good) {
    const fs::path path = folder / "damaged.e57";
    std::size_t read = 0;
    for (int i = 0; i < 3000; ++i) {
      std::string bytes = damaged(logical, rng);
      bytes.resize(logical.size(), ' ');
      if (i % 4 != 0) bytes.replace(0, 48, logical, 0, 48);  // the header is soon dead, then nothing is tested
      fs::remove(path);
      std::ofstream(path, std::ios::binary) << paged(bytes);
      read_in_every_way(path);
      read += scans_of_file(path) ? 1 : 0;
      ASSERT_FALSE(HasFailure()) << "damaged for the " << i << "th time";
    }
    EXPECT_GT(read, 300U);
  }
}

/// While it lives, the process can have only so much more memory.
class LittleMemory {
 public:
  LittleMemory() {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they map terabytes at will
    constexpr rlim_t kMore = 256U << 20;
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    ::getrlimit(RLIMIT_AS, &before_);
    const rlimit little{pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)) + kMore, before_.rlim_max};
    limited_ = ::setrlimit(RLIMIT_AS, &little) == 0;
#endif
  }
  ~LittleMemory() {
    if (limited_) ::setrlimit(RLIMIT_AS, &before_);
  }
  LittleMemory(const LittleMemory&) = delete;
  LittleMemory& operator=(const LittleMemory&) = delete;

 private:
  rlimit before_{};
  bool limited_ = false;
};

TEST_F(Damage, HeadersThatClaimAQuintillionPointsAreErrorsAndTakeNoMemory) {
  const std::string many = "1000000000000000000";
  const std::string xyz = "1 2 3\n4 5 6\n";
  const std::string floats(24, '\x3F');
  const auto ply = [&](const std::string& format) {
    return "ply\nformat " + format + " 1.0\nelement vertex " + many +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  };
  const auto pcd = [&](const std::string& data) {
    return "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + many + "\nHEIGHT 1\nPOINTS " +
           many + "\nDATA " + data + "\n";
  };
  HandMadeE57 e57;
  e57.add_scan(1000000000000000000, doubles_xml(kXyz), data_packet({floats, floats, floats}));
  const std::string four_gigabytes(4, '\xFF');
  const std::vector<fs::path> files = {
      write("ascii.ply", ply("ascii") + xyz),
      write("little.ply", ply("binary_little_endian") + floats),
      write("big.ply", ply("binary_big_endian") + floats),
      write("ascii.pcd", pcd("ascii") + xyz),
      write("binary.pcd", pcd("binary") + floats),
      write("compressed.pcd", pcd("binary_compressed") + four_gigabytes + four_gigabytes + floats),
      write("a.ptx", many + "\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"),
      write("a.e57", e57.file()),
  };
  const LittleMemory little;
  for (const fs::path& file : files) {
    const auto scans = scans_of_file(file);
    if (!scans) continue;
    EXPECT_FALSE(read_whole(scans->at(0))) << file;
    EXPECT_FALSE(inspect_scan(scans->at(0))) << file;
    (void)probe_scan(scans->at(0), 100);
  }
}

TEST_F(Damage, FilesOfOtherProgramsNeverCrash) {
  ISTHMUS_SHARED_DATA_OR_SKIP(data);
  for (const char* name : {"las_pdal/hextest.las",
                           "las_pdal/spec_3.las",
                           "las_pdal/extrabytes.las",
                           "laz_pdal/simple.laz",
                           "laz_pdal/simple-laszip-compressor-version-1.2r0.laz",
                           "pcd_pcl/octants.pcd",
                           "pcd_pcl/car6.pcd",
                           "pcd_pdal/autzen-utm.pcd",
                           "ptx_pdal/multiple-and-transform.ptx",
                           "pts_pdal/test.pts",
                           "ply_pdal/mesh.ply",
                           "ply_pdal/simple_binary.ply",
                           "ply_trimesh/points_ascii_with_lists.ply",
                           "ply_trimesh/tet.ply",
                           "ply_tinyply/icosahedron.ply",
                           "obj_pdal/box.obj",
                           "e57_libe57format/ColourRepresentation.e57",
                           "e57_pye57/translationWithoutRotation.e57",
                           "text_pdal/quoted.txt",
                           "text_pdal/utm17_3.txt"}) {
    damage_often(data / "formats" / name, 100);
  }
}

}  // namespace
}  // namespace isthmus::io::testing
