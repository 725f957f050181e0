#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "pipelines/scan_products.h"

namespace isthmus::pipelines {
namespace {

TEST(ProductCache, loads_once_while_a_product_is_in_use_or_among_the_last) {
  std::vector<int> loads;
  ProductCache cache(4, 2, [&](int id) -> Result<ScanProduct> {
    loads.push_back(id);
    return ScanProduct{};
  });
  const auto held = cache.get(0).value();
  (void)cache.get(1);
  (void)cache.get(2);
  (void)cache.get(0);  // still held
  EXPECT_EQ(loads, (std::vector<int>{0, 1, 2}));
  (void)cache.get(3);
  (void)cache.get(1);  // 0 and 3 are the last two
  EXPECT_EQ(loads, (std::vector<int>{0, 1, 2, 3, 1}));
}

TEST(ProductCache, a_failure_is_not_kept) {
  int calls = 0;
  ProductCache cache(1, 1, [&](int) -> Result<ScanProduct> {
    if (++calls == 1) return fail("no");
    return ScanProduct{};
  });
  EXPECT_FALSE(cache.get(0));
  EXPECT_TRUE(cache.get(0));
}

TEST(ProductCache, threads_that_want_the_same_wait_for_one_loading) {
  std::atomic<int> loads{0};
  ProductCache cache(1, 1, [&](int) -> Result<ScanProduct> {
    ++loads;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return ScanProduct{};
  });
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) threads.emplace_back([&] { EXPECT_TRUE(cache.get(0)); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(loads, 1);
}

}  // namespace
}  // namespace isthmus::pipelines
