// Real scans of a facade in other formats: the same poses.
#include "end_to_end/converted_survey.h"
#include "io/shared_data.h"

namespace isthmus::testing {
namespace {

class SharedFormats : public ConvertedSurvey {
 protected:
  void SetUp() override {
    ISTHMUS_SHARED_DATA_OR_SKIP(data);
    fs::create_directories(scans_);
    for (const auto& entry : fs::directory_iterator(data / "tls_eth_facade"))
      if (entry.path().extension() == ".pcd") fs::copy(entry.path(), scans_);
    original_ = poses_of(scans_, out_);
    ASSERT_EQ(original_.size(), 7U);
  }
  std::vector<Transform> original_;
};

TEST_F(SharedFormats, ptx_gives_the_poses_of_the_original_files) {
  expect_same_poses(original_, poses_of(in_one_ptx(scans_), folder_ / "out_ptx"));
}

TEST_F(SharedFormats, las_in_map_coordinates_gives_the_poses_of_the_original_files) {
  const fs::path las = in_map_coordinates(scans_);
  const std::string stations = "sampling.stations=" + (folder_ / "stations.csv").string();
  expect_same_poses(original_, poses_of(las, folder_ / "out_las", {"--set", stations}), station_in_map_);
}

TEST_F(SharedFormats, e57_of_floats_gives_the_poses_of_the_original_files_digit_by_digit) {
  const std::vector<Transform> poses = poses_of(converted(scans_, "e57"), folder_ / "out_e57");
  ASSERT_EQ(poses.size(), original_.size());
  for (std::size_t k = 0; k < poses.size(); ++k) EXPECT_EQ(poses[k].matrix(), original_[k].matrix());
}

}  // namespace
}  // namespace isthmus::testing
