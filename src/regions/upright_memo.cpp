#include "regions/upright_memo.h"

#include <algorithm>

namespace isthmus {
namespace {

std::array<float, 12> key_of(const Eigen::Matrix3f& z_from_scan, const std::array<float, 3>& options) {
  std::array<float, 12> key{};
  std::copy_n(z_from_scan.data(), 9, key.begin());
  std::ranges::copy(options, key.begin() + 9);
  return key;
}

// Made outside the lock: what makes it may wait for other tasks.
template <class T>
std::shared_ptr<const T> found_or_made(std::mutex& mutex,
                                       std::map<std::array<float, 12>, std::shared_ptr<const T>>& all,
                                       const std::array<float, 12>& key, const std::function<T()>& make) {
  {
    const std::lock_guard lock(mutex);
    if (const auto found = all.find(key); found != all.end()) return found->second;
  }
  auto made = std::make_shared<const T>(make());
  const std::lock_guard lock(mutex);
  return all.try_emplace(key, std::move(made)).first->second;
}

}  // namespace

UprightMemo& UprightMemo::operator=(const UprightMemo& other) {
  if (this == &other) return *this;
  const std::lock_guard lock(mutex_);
  stems_.clear(), plans_.clear();
  return *this;
}

std::shared_ptr<const std::vector<Stem>> UprightMemo::stems(const Eigen::Matrix3f& z_from_scan, int min_layers,
                                                            const std::function<std::vector<Stem>()>& make) {
  return found_or_made(mutex_, stems_, key_of(z_from_scan, {static_cast<float>(min_layers), 0, 0}), make);
}

std::shared_ptr<const GroundPlan> UprightMemo::plan(const Eigen::Matrix3f& z_from_scan,
                                                    const GroundPlanOptions& options,
                                                    const std::function<GroundPlan()>& make) {
  const std::array<float, 3> asked{options.cell_voxels, static_cast<float>(options.min_height_voxels),
                                   static_cast<float>(options.max_columns)};
  return found_or_made(mutex_, plans_, key_of(z_from_scan, asked), make);
}

}  // namespace isthmus
