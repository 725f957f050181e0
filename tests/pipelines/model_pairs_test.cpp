// Looks at many pairs by several processes: each begins with its part and takes what the others made.
#include "pipelines/model_pairs.h"

#include <gtest/gtest.h>

#include <set>

#include "base/temporary_folder.h"
#include "pairwise/synthetic_product.h"

namespace isthmus::pipelines {
namespace {

class ModelPairs : public ::testing::Test {
 protected:
  static constexpr int kScans = 24;  // three blocks of eight, so six units of pairs
  testing::TemporaryFolder folder_;
  store::Store store_ = store::Store::open(folder_ / "store", [](const Error&) {}).value();
  std::vector<ScanPlan> plans_ = std::vector<ScanPlan>(kScans);
  std::map<int, const ScanPlan*> plan_of_;
  std::vector<std::pair<int, int>> pairs_;
  std::vector<int> loaded_;  // by the serial arena: in the order of asking
  const std::atomic<bool> never_stop_{false};

  void SetUp() override {
    for (int id = 0; id < kScans; ++id) {
      ScanPlan& plan = plans_[static_cast<std::size_t>(id)];
      plan.id = id;
      plan.regions = store::make_key("regions", "1", std::array<std::string, 1>{std::to_string(id)});
      plan_of_[id] = &plan;
      for (int target = 0; target < id; ++target) {
        if ((id + target) % 6 == 0) pairs_.emplace_back(id, target);  // some of every unit: a glance takes a while
      }
    }
  }
  std::vector<ScreenedPair> glance(const Share& share, const ScanProduct* product) {
    loaded_.clear();
    std::mutex mutex;
    const ModelSources sources{plan_of_, store_,
                               [&](int id) -> Result<ScanProduct> {
                                 const std::lock_guard lock(mutex);
                                 loaded_.push_back(id);
                                 if (product == nullptr) return fail("none");
                                 return *product;
                               },
                               share};
    return screen_pairs(pairs_, sources, {}, never_stop_);
  }
};

TEST_F(ModelPairs, each_share_begins_elsewhere) {
  const auto first_block = [&](const Share& share) {
    glance(share, nullptr);
    EXPECT_FALSE(loaded_.empty());
    return loaded_.empty() ? -1 : loaded_.front() / 8;
  };
  EXPECT_EQ(first_block({}), 0);
  EXPECT_EQ(first_block({0, 2}), 0);
  EXPECT_EQ(first_block({1, 2}), 1);
  EXPECT_EQ(first_block({5, 6}), 2);
}

TEST_F(ModelPairs, what_a_share_stored_no_other_makes_again_and_the_answers_are_those_of_one_process) {
  const auto pair = testing::partial_overlap(7, {0, 0, 0.5}, 6000);
  const auto all = glance({1, 3}, &pair.source);
  EXPECT_FALSE(loaded_.empty());
  const auto again = glance({0, 3}, &pair.target);  // would answer otherwise if it looked
  EXPECT_TRUE(loaded_.empty());
  ASSERT_EQ(all.size(), again.size());

  testing::TemporaryFolder other;
  store_ = store::Store::open(other / "store", [](const Error&) {}).value();
  const auto whole = glance({}, &pair.source);
  ASSERT_EQ(all.size(), whole.size());
  EXPECT_FALSE(all.empty());
  for (std::size_t k = 0; k < all.size(); ++k) {
    for (const auto* got : {&all[k], &again[k]}) {
      EXPECT_EQ(got->source, whole[k].source);
      EXPECT_EQ(got->target, whole[k].target);
      EXPECT_EQ(got->score, whole[k].score);
    }
  }
}

TEST_F(ModelPairs, two_shares_at_the_same_time_share_the_work) {
  const auto pair = testing::partial_overlap(7, {0, 0, 0.5}, 6000);
  // The second works when the first has done one unit of six: it makes the five others and loads nothing for the first.
  std::vector<int> of_second;
  bool ran = false;
  std::vector<int> of_first;
  std::mutex mutex;
  const auto sources = [&](const Share& share, std::vector<int>& loads) {
    return ModelSources{plan_of_, store_,
                        [&](int id) -> Result<ScanProduct> {
                          const std::lock_guard lock(mutex);
                          loads.push_back(id);
                          return pair.source;
                        },
                        share};
  };
  const ModelSources first = sources({0, 2}, of_first), second = sources({1, 2}, of_second);
  const Events events{{}, [&](const std::string&, std::size_t, std::size_t) {
                        if (ran) return;
                        ran = true;
                        screen_pairs(pairs_, second, {}, never_stop_);
                      }};
  screen_pairs(pairs_, first, events, never_stop_);
  EXPECT_FALSE(of_first.empty());
  for (const int id : of_first) EXPECT_LT(id, 8) << "not of its first unit";
  EXPECT_EQ(std::set<int>(of_second.begin(), of_second.end()).size(), static_cast<std::size_t>(kScans));
}

TEST_F(ModelPairs, PlansAreComparedOnceAndAnewWhereAScanIsAnother) {
  for (ScanPlan& plan : plans_)
    plan.summary = store::make_key("summary", "1", std::array<std::string, 1>{plan.regions.digest});
  std::atomic<std::size_t> num_compared{0};
  const auto compare = [&](std::size_t k) {
    ++num_compared;
    return static_cast<float>(k);
  };
  const ModelSources sources{plan_of_, store_, {}, {}};
  const auto compared = [&](const std::atomic<bool>& stop) {
    return compare_plans(pairs_, compare, sources, {}, stop);
  };
  const std::atomic<bool> stopped{true};
  EXPECT_EQ(compared(stopped), std::vector<float>(pairs_.size(), 0.0F));
  EXPECT_EQ(num_compared, 0U) << "told to stop";
  const auto first = compared(never_stop_);
  EXPECT_EQ(num_compared, pairs_.size()) << "what was stopped is not kept";
  EXPECT_EQ(first[5], 5.0F);
  EXPECT_EQ(compared(never_stop_), first);
  EXPECT_EQ(num_compared, pairs_.size());
  plans_[3].summary = store::make_key("summary", "1", std::array<std::string, 1>{"another"});
  compared(never_stop_);
  EXPECT_EQ(num_compared, 2 * pairs_.size());
}

}  // namespace
}  // namespace isthmus::pipelines
