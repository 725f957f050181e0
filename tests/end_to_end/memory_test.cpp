// The largest scan decides nothing about the memory: it is read as a stream.
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>

#include "base/rng.h"
#include "end_to_end/survey_on_disk.h"

namespace isthmus::testing {
namespace {

/// ISTHMUS_MEMORY_POINTS, else 2 million; tools/test.sh asks for 10 million, tools/full_check.sh for 100 million.
std::size_t num_points() {
  constexpr std::size_t kFew = 2'000'000;
  const char* text = std::getenv("ISTHMUS_MEMORY_POINTS");
  return text != nullptr ? std::strtoull(text, nullptr, 10) : kFew;
}

/// A room of 20 x 14 x 4 m with a block in it, seen from `station`: points on its surfaces, binary PLY, written as they
/// are made.
void write_room(const fs::path& path, std::size_t count, const Eigen::Vector3f& station, Rng& rng) {
  std::ofstream file(path, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\nend_header\n";
  struct Box {
    Eigen::Vector3f low, high;
  };
  const std::array<Box, 3> boxes = {Box{{-10, -7, 0}, {10, 7, 4}}, Box{{3, 1, 0}, {5, 5, 2.5F}},
                                    Box{{-7, -6, 0}, {-4, -5, 1}}};
  constexpr std::size_t kPiece = 1 << 16;
  std::vector<std::array<float, 4>> piece;
  for (std::size_t done = 0; done < count; done += piece.size()) {
    piece.resize(std::min(kPiece, count - done));
    for (auto& point : piece) {
      const Box& box = boxes[std::min<std::size_t>(rng.below(10), 2)];  // most of them on the room itself
      Eigen::Vector3f p;
      for (int axis = 0; axis < 3; ++axis) {
        p[axis] = box.low[axis] + (box.high[axis] - box.low[axis]) * static_cast<float>(rng.uniform());
      }
      const auto side = static_cast<Eigen::Index>(rng.below(3));
      p[side] = rng.below(2) == 0 ? box.low[side] : box.high[side];
      p -= station;
      point = {p.x(), p.y(), p.z(), 0.5F};
    }
    file.write(reinterpret_cast<const char*>(piece.data()),
               static_cast<std::streamsize>(piece.size() * sizeof piece[0]));
  }
}

class Memory : public SurveyOnDisk {};

TEST_F(Memory, of_a_scan_of_any_number_of_points_stays_below_one_and_a_half_gigabytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need memory of their own";
#endif
  constexpr double kMostBytes = 1.5e9;
  constexpr std::size_t kOther = 200'000;
  fs::create_directories(scans_);
  Rng rng(20261127);
  write_room(scans_ / "large.ply", num_points(), {0, 0, 1.6F}, rng);
  write_room(scans_ / "small.ply", kOther, {-2, 1, 1.5F}, rng);
  const Said said = register_scans({"--threads", "2"});
  EXPECT_TRUE(said.exit_code == 0 || said.exit_code == 3) << said.err;
  const std::string table = text_of_file(out_ / "scans.csv");
  EXPECT_EQ(table.find("failed"), std::string::npos) << table;
  EXPECT_NE(table.find(std::to_string(num_points())), std::string::npos) << table;  // all were read
  rusage usage{};
  ASSERT_EQ(::getrusage(RUSAGE_CHILDREN, &usage), 0);
  const double bytes = 1024.0 * static_cast<double>(usage.ru_maxrss);
  std::printf("%zu points: %.0f MB at most\n", num_points(), bytes / 1e6);
  RecordProperty("most_megabytes", static_cast<int>(bytes / 1e6));
  EXPECT_LT(bytes, kMostBytes);
}

}  // namespace
}  // namespace isthmus::testing
