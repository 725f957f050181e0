#include "config/yaml.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "config/toy_options.h"

namespace isthmus::config {
namespace {

class Yaml : public ::testing::Test {
 protected:
  ToyOptions options_;
  std::vector<Stage> stages_{bind(toy_table(), options_)};
  Origins origins_;

  std::string apply(const std::string& text) {
    const Result<YAML::Node> node = parse_yaml(text, "survey.yaml");
    if (!node) return node.error().text();
    const Result<void> done = apply_yaml(*node, stages_, "survey.yaml", origins_);
    return done ? "" : done.error().text();
  }
};

TEST_F(Yaml, sets_values_and_remembers_their_lines) {
  EXPECT_EQ(apply("# a comment\ntoy:\n  voxel_m: 0.25\n  loops: false\n  names: [a, \"b,c\"]\n"), "");
  EXPECT_EQ(options_.voxel_m, 0.25);
  EXPECT_FALSE(options_.loops);
  EXPECT_EQ(options_.names, (std::vector<std::string>{"a", "b,c"}));
  EXPECT_EQ(origins_.at("toy.voxel_m"), "survey.yaml:3");
  EXPECT_EQ(origins_.at("toy.names"), "survey.yaml:5");
  EXPECT_EQ(origins_.size(), 3U);
}

TEST_F(Yaml, auto_is_automatic_and_a_quoted_auto_is_a_text) {
  EXPECT_EQ(apply("toy: {voxel_m: auto, names: [\"auto\"]}"), "");
  EXPECT_FALSE(options_.voxel_m);
  EXPECT_EQ(apply("toy: {voxel_m: \"auto\"}"),
            "survey.yaml:1:16: toy.voxel_m = auto is no number (expected number or auto)");
}

TEST_F(Yaml, nothing_is_no_change) {
  EXPECT_EQ(apply(""), "");
  EXPECT_EQ(apply("toy:\n"), "");
  EXPECT_TRUE(origins_.empty());
}

TEST_F(Yaml, errors_name_line_and_column_and_the_nearest_key) {
  EXPECT_EQ(apply("toy:\n  radius: 1\n  trails: 5\n"), "survey.yaml:3:3: unknown key 'trails' (did you mean trials?)");
  EXPECT_EQ(apply("ty:\n  radius: 1\n"), "survey.yaml:1:1: unknown key 'ty' (did you mean toy?)");
  EXPECT_EQ(apply("toy:\n  radius: 101\n"),
            "survey.yaml:2:11: toy.radius = 101 is out of range (allowed: 0 to 100 voxels)");
  EXPECT_EQ(apply("toy:\n  radius: 1\n  radius: 2\n"), "survey.yaml:3:3: key 'radius' is given twice");
  EXPECT_EQ(apply("toy:\n  radius:\n"), "survey.yaml:2:3: toy.radius has no value (write a value or auto)");
  EXPECT_EQ(apply("toy:\n  radius: [1\n").substr(0, 12), "survey.yaml:");
  EXPECT_EQ(apply("- a\n- b\n"), "survey.yaml:1:1: a mapping (key: value) is expected");
  EXPECT_EQ(apply("toy: 5\n"), "survey.yaml:1:6: a mapping (key: value) is expected");
  EXPECT_EQ(apply("toy: {radius: {a: 1}}\n"), "survey.yaml:1:15: a value is missing here (write a value or auto)");
}

}  // namespace
}  // namespace isthmus::config
