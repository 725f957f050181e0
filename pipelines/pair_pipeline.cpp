#include "pipelines/pair_pipeline.h"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <array>
#include <string>

#include "pipelines/frames.h"
#include "pipelines/pair_stage.h"
#include "pipelines/planning.h"
#include "pipelines/scan_positions.h"
#include "report/survey_record.h"

namespace isthmus::pipelines {
namespace {

Result<PairAnswer> register_files(const io::ScanRef& source, const io::ScanRef& target, const Settings& settings,
                                  const store::Store& store, const Events& events) {
  const std::array<std::string, 2> names = {target.name, source.name};
  if (const auto stations = read_stations(settings.sampling.stations, names); !stations)
    return tl::unexpected(stations.error());
  const std::atomic<bool> never_stop{false};
  const SurveyPlan plan = plan_survey({{target, {}}, {source, {}}}, settings, store, events, never_stop);
  PairAnswer answer;
  for (const FailedScan& failed : plan.failed) {
    if (!failed.other_unit) return tl::unexpected(failed.error);
    answer.result.reason = failed.error.text();  // both can be read: an answer, though no pose
    return answer;
  }
  answer.voxel_m = plan.voxel_m;
  const ProductMaker maker(settings, store);
  std::array<std::vector<StageTime>, 2> times;
  ProductCache cache(2, 2, [&](int id) {
    const auto i = static_cast<std::size_t>(id);
    return maker.product(plan.scans[i], times[i]);
  });
  for (const int id : {0, 1}) {  // before the pair: an unreadable scan is an error here, not a failed pair
    if (const auto product = cache.get(id); !product) return tl::unexpected(product.error());
  }
  StoredPair stored =
      register_planned_pair(plan.scans[1], plan.scans[0], settings, digests_of(settings).pair, {}, store, cache);
  answer.result = std::move(stored.result);
  answer.from_store = stored.from_store;
  const auto target_product = cache.get(0), source_product = cache.get(1);
  if (!target_product || !source_product) return fail("a product was lost while it was in use");
  const Eigen::Vector3d source_origin = (*source_product)->sampled.local_origin_in_scan;
  const Eigen::Vector3d target_origin = (*target_product)->sampled.local_origin_in_scan;
  if (answer.result.target_from_source) {
    answer.target_from_source_in_scans =
        between_scan_frames(*answer.result.target_from_source, source_origin, target_origin);
  }
  answer.information_in_scans = report::information_in_scan(answer.result.information, source_origin);
  answer.target_times = times[0];
  answer.source_times = times[1];
  return answer;
}

}  // namespace

Result<PairAnswer> run_pair(const io::ScanRef& source, const io::ScanRef& target, const Settings& settings,
                            const store::Store& store, const Events& events) {
  const auto threads = static_cast<std::size_t>(threads_of(settings.run));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  oneapi::tbb::task_arena arena(static_cast<int>(threads));
  Result<PairAnswer> answer = fail("not computed");
  arena.execute([&] {
    try {
      answer = register_files(source, target, settings, store, events);
    } catch (const std::exception& exception) {
      answer = fail(std::string("internal failure: ") + exception.what());
    }
  });
  return answer;
}

}  // namespace isthmus::pipelines
