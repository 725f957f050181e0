// Runs something with a given number of threads, more than the machine has if need be.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace isthmus::testing {

template <class F>
auto with_threads(int threads, F&& f) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  return arena.execute(f);
}

}  // namespace isthmus::testing
