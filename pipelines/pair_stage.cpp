#include "pipelines/pair_stage.h"

#include "pipelines/code_versions.h"

namespace isthmus::pipelines {
namespace {

PairResult failed(const Error& error) {
  PairResult result;
  result.reason = error.text();
  return result;
}

}  // namespace

store::Key pair_key(const ScanPlan& source, const ScanPlan& target, const std::string& settings_digest,
                    const std::vector<Transform>& priors) {
  const std::vector<std::string> inputs = {source.regions.digest, target.regions.digest, settings_digest,
                                           store::to_bytes(priors)};
  return store::make_key("pair", kPairVersion, inputs);
}

StoredPair register_planned_pair(const ScanPlan& source, const ScanPlan& target, const Settings& settings,
                                 const std::string& settings_digest, const std::vector<Transform>& priors,
                                 const store::Store& store, ProductCache& cache) {
  const store::Key key = pair_key(source, target, settings_digest, priors);
  if (std::optional<PairResult> found = store.load<PairResult>(key)) return {std::move(*found), true};
  const auto source_product = cache.get(source.id);
  if (!source_product) return {failed(source_product.error()), false};
  const auto target_product = cache.get(target.id);
  if (!target_product) return {failed(target_product.error()), false};
  store::Store::Work work = store.work(key, source.ref.name + " with " + target.ref.name);
  PairResult result = register_pair(**source_product, **target_product, settings.pair, priors);
  // Refinement in float leaves rotations good to 1e-7; at map coordinates (5e6 m) that would be half a metre.
  if (result.target_from_source) result.target_from_source = orthonormalised(*result.target_from_source);
  store.keep(key, result);
  work.made();
  return {std::move(result), false};
}

}  // namespace isthmus::pipelines
