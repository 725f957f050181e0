#include "pipelines/byte_gate.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace isthmus::pipelines {
namespace {

TEST(ByteGate, starts_in_order_as_bytes_become_free) {
  ByteGate gate(100, 10);
  std::vector<int> started;
  gate.submit(60, [&] { started.push_back(0); });
  gate.submit(60, [&] { started.push_back(1); });
  gate.submit(10, [&] { started.push_back(2); });  // would fit, but waits its turn
  EXPECT_EQ(started, std::vector<int>{0});
  gate.release(60);
  EXPECT_EQ(started, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(gate.peak_bytes(), 70U);
}

TEST(ByteGate, something_larger_than_the_bound_runs_alone) {
  ByteGate gate(100, 10);
  std::vector<int> started;
  gate.submit(10, [&] { started.push_back(0); });
  gate.submit(1000, [&] { started.push_back(1); });
  gate.submit(10, [&] { started.push_back(2); });
  EXPECT_EQ(started, std::vector<int>{0});
  gate.release(10);
  EXPECT_EQ(started, (std::vector<int>{0, 1}));
  gate.release(1000);
  EXPECT_EQ(started, (std::vector<int>{0, 1, 2}));
}

TEST(ByteGate, bounds_the_number_of_items_too) {
  ByteGate gate(100, 2);
  int started = 0;
  for (int i = 0; i < 3; ++i) gate.submit(1, [&] { ++started; });
  EXPECT_EQ(started, 2);
  gate.release(1);
  EXPECT_EQ(started, 3);
}

TEST(ByteGate, starts_everything_once_under_many_threads_and_holds_the_bound) {
  ByteGate gate(100, 1000);
  std::atomic<int> started{0};
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 500; ++i) {
        std::atomic<bool> mine{false};
        gate.submit(30, [&] { ++started, mine = true; });
        while (!mine) std::this_thread::yield();
        gate.release(30);
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(started, 2000);
  EXPECT_LE(gate.peak_bytes(), 100U);
}

}  // namespace
}  // namespace isthmus::pipelines
