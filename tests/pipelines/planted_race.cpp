// planted_race race|none: the stages of a flow graph as run_survey has them, with or without a race between two tasks
// of a node. tools/tsan.sh runs both to know that ThreadSanitizer sees the one and takes the other for what it is.
#include <tbb/flow_graph.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstdio>
#include <memory>
#include <string_view>
#include <vector>

#include "base/parallel.h"

namespace {

void run(bool race) {
  constexpr int kItems = 200, kValues = 64;
  using Values = std::shared_ptr<const std::vector<int>>;
  int shared = 0;
  long long sum = 0;
  tbb::flow::graph graph;
  tbb::flow::function_node<int, Values> make(graph, tbb::flow::unlimited, [&](int item) -> Values {
    auto values = std::make_shared<std::vector<int>>(kValues);
    isthmus::parallel_for_index(values->size(), 1, [&](std::size_t k) { (*values)[k] = item; });
    if (race) ++shared;
    return values;
  });
  tbb::flow::function_node<Values> add(graph, tbb::flow::serial, [&](const Values& values) {
    for (const int value : *values) sum += value;
  });
  tbb::flow::make_edge(make, add);
  for (int item = 0; item < kItems; ++item) make.try_put(item);
  graph.wait_for_all();
  std::printf("sum %lld, shared %d\n", sum, shared);
}

}  // namespace

int main(int argc, char** argv) {
  constexpr int kThreads = 4;  // whatever the machine has
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, kThreads);
  tbb::task_arena arena(kThreads);
  arena.execute([&] { run(argc == 2 && std::string_view(argv[1]) == "race"); });
}
