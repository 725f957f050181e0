// Parallel loops inside a stage. The program owns the one arena; loops write by index, so the thread count cannot show.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <cstddef>

namespace isthmus {

/// Calls body(i) for every i in [0, n); body must write only to places that belong to i.
template <class Body>
void parallel_for_index(std::size_t n, std::size_t grain, const Body& body) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, grain), [&](const tbb::blocked_range<std::size_t>& r) {
    for (std::size_t i = r.begin(); i != r.end(); ++i) body(i);
  });
}

}  // namespace isthmus
