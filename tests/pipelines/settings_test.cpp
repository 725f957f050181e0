#include "pipelines/settings.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "base/atomic_file.h"
#include "base/temporary_folder.h"
#include "config/describe.h"
#include "config/yaml.h"

namespace isthmus::pipelines {
namespace {

const std::filesystem::path kSource = ISTHMUS_SOURCE_DIR;

TEST(Settings, every_stage_and_key_is_there_once_with_help_and_a_reason) {
  Settings settings;
  std::set<std::string> keys;
  for (const config::Stage& stage : settings.stages()) {
    EXPECT_FALSE(stage.help.empty()) << stage.name;
    for (const config::Option& option : stage.options) {
      EXPECT_TRUE(keys.insert(option.full_key()).second) << option.full_key();
      EXPECT_FALSE(option.help.empty()) << option.full_key();
      EXPECT_FALSE(option.source.empty()) << option.full_key();
    }
  }
  EXPECT_GT(keys.size(), 20U);
}

TEST(Settings, every_default_is_allowed) {
  Settings settings;
  for (config::Stage& stage : settings.stages()) {
    for (config::Option& option : stage.options) {
      const Result<config::Written> written = config::parse_written(option.default_text);
      ASSERT_TRUE(written);
      EXPECT_TRUE(option.assign(*written)) << option.full_key() << " " << option.default_text;
    }
  }
}

TEST(DefaultYaml, in_configs_is_the_generated_one) {
  Settings settings;
  EXPECT_EQ(read_file(kSource / "configs/default.yaml").value(), config::annotated_yaml(settings.stages()))
      << "run: isthmus config default > configs/default.yaml";
}

TEST(ConfigurationPage, holds_the_generated_tables) {
  Settings settings;
  const std::string page = read_file(kSource / "docs/configuration.md").value();
  EXPECT_NE(page.find(config::markdown_tables(settings.stages())), std::string::npos)
      << "run tools/refresh_generated.sh";
}

TEST(DefaultYaml, changes_nothing) {
  Settings settings;
  ASSERT_TRUE(apply_config(settings, (kSource / "configs/default.yaml").string()));
  Settings defaults;
  for (config::Stage& stage : settings.stages()) {
    for (const config::Option& option : stage.options)
      EXPECT_EQ(option.text(), option.default_text) << option.full_key();
  }
}

TEST(Profiles, all_apply_and_say_where_values_came_from) {
  ASSERT_FALSE(profile_names().empty());
  for (const std::string& name : profile_names()) {
    Settings settings;
    const Result<void> done = apply_config(settings, name);
    ASSERT_TRUE(done) << done.error().text();
    ASSERT_FALSE(settings.origins.empty()) << name << " changes nothing";
    EXPECT_TRUE(settings.origins.begin()->second.starts_with("profile " + name + ":"));
  }
  Settings settings;
  const Result<void> missing = apply_config(settings, "quik");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().text(), "quik: there is no such configuration file or profile (did you mean quick?)");
}

TEST(Settings, later_ones_win_and_a_file_goes_before_a_profile_of_its_name) {
  const testing::TemporaryFolder folder;
  std::ofstream(folder / "a.yaml") << "sampling:\n  target_points: 5000\n";
  Settings settings;
  ASSERT_TRUE(apply_config(settings, (folder / "a.yaml").string()));
  EXPECT_EQ(settings.sampling.target_points, 5000);
  ASSERT_TRUE(apply_assignments(settings, {"sampling.target_points=6000"}));
  EXPECT_EQ(settings.sampling.target_points, 6000);
  EXPECT_EQ(settings.origins.at("sampling.target_points"), "--set");
}

TEST(SettingsDigests, belong_to_their_stages) {
  Settings a, b;
  b.features.max_keypoints += 1;
  b.run.threads = 3;
  EXPECT_EQ(digests_of(a).sampling, digests_of(b).sampling);
  EXPECT_NE(digests_of(a).features, digests_of(b).features);
  EXPECT_EQ(digests_of(a).pair, digests_of(b).pair);
}

TEST(RunOptions, automatic_values_come_from_the_machine) {
  EXPECT_GE(threads_of({}), 1);
  EXPECT_EQ(threads_of({.threads = 7, .memory_gb = {}, .store = ""}), 7);
  EXPECT_GT(memory_bytes_of({}), std::size_t{100} << 20);
  EXPECT_EQ(memory_bytes_of({.threads = {}, .memory_gb = 1.5, .store = ""}), 1500000000U);
}

}  // namespace
}  // namespace isthmus::pipelines
