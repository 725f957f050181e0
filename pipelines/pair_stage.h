// One pair of scans with planned products: found in the store or registered.
#pragma once

#include <vector>

#include "pipelines/scan_products.h"

namespace isthmus::pipelines {

/// Where the result of a pair lies, or will lie.
store::Key pair_key(const ScanPlan& source, const ScanPlan& target, const std::string& settings_digest,
                    const std::vector<Transform>& priors);

struct StoredPair {
  PairResult result;
  bool from_store = false;
};

/// `priors` are target_from_source between local frames. Products are asked of `cache` only when the store has no
/// result. Never fails: products that cannot be had give Verdict::failed with the reason.
StoredPair register_planned_pair(const ScanPlan& source, const ScanPlan& target, const Settings& settings,
                                 const std::string& settings_digest, const std::vector<Transform>& priors,
                                 const store::Store& store, ProductCache& cache);

}  // namespace isthmus::pipelines
