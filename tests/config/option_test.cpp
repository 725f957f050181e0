#include "config/option.h"

#include <gtest/gtest.h>

#include "config/toy_options.h"

namespace isthmus::config {
namespace {

class Assignment : public ::testing::Test {
 protected:
  ToyOptions options_;
  std::vector<Stage> stages_{bind(toy_table(), options_)};
  Origins origins_;

  Result<void> set(const std::string& text) { return apply_assignment(stages_, text, origins_); }
  std::string error_of(const std::string& text) {
    const Result<void> done = set(text);
    return done ? "no error" : done.error().text();
  }
};

TEST_F(Assignment, sets_every_kind) {
  ASSERT_TRUE(set("toy.voxel_m=0.05"));
  ASSERT_TRUE(set("toy.radius=3"));
  ASSERT_TRUE(set("toy.trials=7"));
  ASSERT_TRUE(set("toy.loops=false"));
  ASSERT_TRUE(set("toy.method=slow"));
  ASSERT_TRUE(set("toy.names=[a.ply, 'b c.ply']"));
  ASSERT_TRUE(set("toy.threads=2"));
  EXPECT_EQ(options_.voxel_m, 0.05);
  EXPECT_EQ(options_.radius, 3.0);
  EXPECT_EQ(options_.trials, 7);
  EXPECT_FALSE(options_.loops);
  EXPECT_EQ(options_.method, "slow");
  EXPECT_EQ(options_.names, (std::vector<std::string>{"a.ply", "b c.ply"}));
  EXPECT_EQ(options_.threads, 2);
  EXPECT_EQ(origins_.at("toy.radius"), "--set");
  ASSERT_TRUE(set("toy.voxel_m=auto"));
  EXPECT_FALSE(options_.voxel_m);
  ASSERT_TRUE(set("toy.names=one.ply"));
  EXPECT_EQ(options_.names, std::vector<std::string>{"one.ply"});
}

TEST_F(Assignment, refuses_with_the_allowed_range_and_changes_nothing) {
  EXPECT_EQ(error_of("toy.voxel_m=-1"),
            "--set toy.voxel_m=-1: toy.voxel_m = -1 is out of range (allowed: 0.0001 to 10 m)");
  EXPECT_EQ(error_of("toy.radius=wide"), "--set toy.radius=wide: toy.radius = wide is no number (expected number)");
  EXPECT_EQ(error_of("toy.trials=1.5"),
            "--set toy.trials=1.5: toy.trials = 1.5 is no whole number (expected whole number)");
  EXPECT_NE(error_of("toy.trials=99999999999"), "no error");
  EXPECT_NE(error_of("toy.radius=nan"), "no error");
  EXPECT_NE(error_of("toy.radius=auto"), "no error");
  EXPECT_NE(error_of("toy.radius="), "no error");
  EXPECT_NE(error_of("toy.loops=maybe"), "no error");
  EXPECT_NE(error_of("toy.radius=[1, 2]"), "no error");
  EXPECT_EQ(error_of("toy.method=fastt"),
            "--set toy.method=fastt: toy.method = fastt is not one of fast, slow (did you mean fast?)");
  EXPECT_FALSE(options_.voxel_m);
  EXPECT_EQ(options_.radius, 2.5);
  EXPECT_EQ(options_.trials, 100);
  EXPECT_TRUE(origins_.empty());
}

TEST_F(Assignment, names_the_nearest_key) {
  EXPECT_EQ(error_of("toy.vxel_m=1"), "--set toy.vxel_m=1: unknown key 'toy.vxel_m' (did you mean toy.voxel_m?)");
  EXPECT_NE(error_of("toy.voxel_m"), "no error");
}

TEST(SettingsDigest, changes_with_results_only) {
  ToyOptions options;
  const std::string before = settings_digest(bind(toy_table(), options));
  options.threads = 3;
  EXPECT_EQ(settings_digest(bind(toy_table(), options)), before);
  options.voxel_m = 0.1;
  const std::string with_voxel = settings_digest(bind(toy_table(), options));
  EXPECT_NE(with_voxel, before);
  options.voxel_m = 0.1 + 1e-17 + 1e-16;
  EXPECT_EQ(settings_digest(bind(toy_table(), options)) == with_voxel, *options.voxel_m == 0.1);
}

TEST(OptionText, numbers_read_back_to_the_same_bits) {
  ToyOptions options;
  for (const double value : {0.1, 1.0 / 3.0, 1e-7, 99.999999999999986}) {
    options.radius = value;
    Stage stage = bind(toy_table(), options);
    Option& radius = stage.options[1];
    const std::string text = radius.text();
    options.radius = 0;
    ASSERT_TRUE(radius.assign({{text}, false, false}));
    EXPECT_EQ(options.radius, value) << text;
  }
}

}  // namespace
}  // namespace isthmus::config
