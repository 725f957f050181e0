// Which voxels of space have been met: a set that takes 16 to 32 bytes a voxel.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <vector>

namespace isthmus::pipelines {

/// Open addressing over keys of 3 x 21 bits, counted from `middle`: cells beyond a million edges from it share keys
/// with others, which merges what is 2 million edges apart.
class OccupiedVoxels {
 public:
  OccupiedVoxels(const Eigen::Vector3d& middle, double voxel_m)
      : middle_(middle), voxel_m_(voxel_m), slots_(1 << 12, kFree) {}

  /// Whether the point's voxel was free until now.
  bool insert(const Eigen::Vector3d& p) {
    if (2 * count_ >= slots_.size()) grow();
    const bool is_new = put(key_of(p));
    count_ += is_new ? 1 : 0;
    return is_new;
  }
  [[nodiscard]] std::size_t size() const { return count_; }

 private:
  static constexpr std::uint64_t kFree = ~std::uint64_t{0};  // a key has 63 bits

  [[nodiscard]] std::uint64_t key_of(const Eigen::Vector3d& p) const {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << 21) - 1;
    std::uint64_t key = 0;
    for (int k = 0; k < 3; ++k) {
      const auto cell = static_cast<std::int64_t>(std::floor((p[k] - middle_[k]) / voxel_m_));
      key = key << 21 | (static_cast<std::uint64_t>(cell) & kMask);
    }
    return key;
  }
  bool put(std::uint64_t key) {
    const std::uint64_t mask = slots_.size() - 1;
    std::uint64_t mixed = (key ^ key >> 33) * 0xff51afd7ed558ccdULL;
    mixed ^= mixed >> 33;
    for (std::uint64_t slot = mixed & mask;; slot = (slot + 1) & mask) {
      if (slots_[slot] == key) return false;
      if (slots_[slot] != kFree) continue;
      slots_[slot] = key;
      return true;
    }
  }
  void grow() {
    std::vector<std::uint64_t> old(2 * slots_.size(), kFree);
    old.swap(slots_);
    for (const std::uint64_t key : old)
      if (key != kFree) put(key);
  }

  Eigen::Vector3d middle_;
  double voxel_m_;
  std::size_t count_ = 0;
  std::vector<std::uint64_t> slots_;
};

}  // namespace isthmus::pipelines
