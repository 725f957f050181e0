#include "congruent/best_transforms.h"

#include <algorithm>
#include <iterator>

namespace isthmus::congruent {
namespace {

void add_voters(std::vector<int>& voters, const std::vector<int>& more) {
  std::vector<int> all;
  std::set_union(voters.begin(), voters.end(), more.begin(), more.end(), std::back_inserter(all));
  voters = std::move(all);
}

}  // namespace

bool BestTransforms::same(const Transform& a, const Transform& b) const {
  const double apart_m = (a.translation() - b.translation()).norm();
  if (apart_m >= distinct_m_) return false;
  return apart_m + radius_m_ * rotation_angle_rad(a.linear().transpose() * b.linear()) < distinct_m_;
}

bool BestTransforms::add(const CountedTransform& candidate) {
  if (candidate.common <= floor_) return false;
  const auto is_twin = [&](const CountedTransform& k) {
    return same(k.target_from_source, candidate.target_from_source);
  };
  const auto lesser =
      std::find_if(kept_.begin(), kept_.end(), [&](const auto& k) { return k.common < candidate.common; });
  const auto better_twin = std::find_if(kept_.begin(), lesser, is_twin);
  if (better_twin != lesser) {
    add_voters(better_twin->voters, candidate.voters);
    return false;
  }
  if (candidate.common <= to_beat()) return false;
  CountedTransform heir = candidate;
  for (auto twin = std::find_if(lesser, kept_.end(), is_twin); twin != kept_.end();
       twin = std::find_if(twin, kept_.end(), is_twin)) {
    add_voters(heir.voters, twin->voters);
    twin = kept_.erase(twin);
  }
  const auto place = std::find_if(kept_.begin(), kept_.end(), [&](const auto& k) { return k.common < heir.common; });
  kept_.insert(place, heir);
  if (kept_.size() > capacity_) kept_.pop_back();
  return true;
}

}  // namespace isthmus::congruent
