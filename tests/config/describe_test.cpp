#include "config/describe.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include "config/toy_options.h"
#include "config/yaml.h"

namespace isthmus::config {
namespace {

TEST(AnnotatedYaml, reads_back_as_the_defaults) {
  ToyOptions options;
  options.radius = 1;  // text shows defaults whatever the values are
  std::vector<Stage> stages{bind(toy_table(), options)};
  const std::string text = annotated_yaml(stages);
  EXPECT_NE(
      text.find(
          "  # Edge of the voxels.\n  # [number or auto, 0.0001 to 10 m]\n  # Default: Measured.\n  voxel_m: auto\n"),
      std::string::npos)
      << text;
  Origins origins;
  ASSERT_TRUE(apply_yaml(parse_yaml(text, "f").value(), stages, "f", origins));
  EXPECT_EQ(options.radius, 2.5);
  EXPECT_EQ(origins.size(), toy_table().rows.size());
}

TEST(ResolvedYaml, reads_back_as_the_values_and_says_where_they_came_from) {
  ToyOptions options;
  options.radius = 1.0 / 3.0;
  options.names = {"a b", "auto", "", "-1", "say \"no\""};
  std::vector<Stage> stages{bind(toy_table(), options)};
  const std::string text = resolved_yaml(stages, {{"toy.radius", "--set"}}, 0);
  EXPECT_NE(text.find("# --set\n"), std::string::npos);
  EXPECT_NE(text.find("trials: 100  # default\n"), std::string::npos);
  ToyOptions again;
  std::vector<Stage> stages_again{bind(toy_table(), again)};
  Origins origins;
  ASSERT_TRUE(apply_yaml(parse_yaml(text, "f").value(), stages_again, "f", origins));
  EXPECT_EQ(again.radius, options.radius);
  EXPECT_EQ(again.names, options.names);
}

TEST(Explanation, says_what_why_and_which_values) {
  ToyOptions options;
  const Stage stage = bind(toy_table(), options);
  EXPECT_EQ(explanation(stage.options[0]),
            "toy.voxel_m (number or auto, 0.0001 to 10 m)\nEdge of the voxels.\ndefault: auto\nwhy: Measured.\n");
}

TEST(MarkdownTables, have_a_row_for_each_option) {
  ToyOptions options;
  const std::vector<Stage> stages{bind(toy_table(), options)};
  const std::string text = markdown_tables(stages);
  EXPECT_NE(text.find("| `method` | `fast` | one of fast, slow | Which way. |  |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| `loops` | `true` | true or false | Whether"), std::string::npos) << text;
  EXPECT_NE(text.find("How often \\| how long."), std::string::npos);
}

}  // namespace
}  // namespace isthmus::config
