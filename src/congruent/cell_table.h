// From an integer cell to a range of entries: the open-addressing table under both hash grids of this module.
#pragma once

#include <Eigen/Core>
#include <bit>
#include <cstdint>
#include <vector>

namespace isthmus::congruent {

using CellKey = std::uint64_t;

/// Key of the cell that holds `p`, 21 bits an axis. Precondition: |p| / cell edge below 2^20, see kMaxCells.
inline constexpr float kMaxCells = 1048576.0F;
inline CellKey cell_key(const Eigen::Vector3i& cell) {
  const auto axis = [](int i) { return static_cast<CellKey>(i + (1 << 20)) & 0x1FFFFFU; };
  return (axis(cell.x()) << 42) | (axis(cell.y()) << 21) | axis(cell.z());
}
/// Floor by truncation: without SSE 4.1 std::floor is a call.
inline int floor_to_int(float x) {
  const int truncated = static_cast<int>(x);
  return truncated - (static_cast<float>(truncated) > x ? 1 : 0);
}
inline Eigen::Vector3i cell_of(const Eigen::Vector3f& p, float inverse_edge) {
  return {floor_to_int(p.x() * inverse_edge), floor_to_int(p.y() * inverse_edge), floor_to_int(p.z() * inverse_edge)};
}

/// Entries [begin, end) of one cell.
struct CellRange {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// Groups entries by cell once, by counting and hashing in linear time; then only read.
class CellTable {
 public:
  CellTable() = default;
  /// keys[i] is the cell of entry i. `order` becomes the entries grouped by cell, each cell's in ascending order; the
  /// ranges that find() returns lie in it.
  CellTable(const std::vector<CellKey>& keys, std::vector<std::uint32_t>& order)
      : slots_(std::bit_ceil(keys.size() * 2 + 1)) {
    std::vector<std::uint32_t> slot_of_entry(keys.size());
    for (std::size_t i = 0; i < keys.size(); ++i) {
      std::size_t s = slot(keys[i]);
      while (slots_[s].range.end != 0 && slots_[s].key != keys[i]) s = (s + 1) & (slots_.size() - 1);
      slots_[s].key = keys[i];
      ++slots_[s].range.end;  // a count until the ranges are laid out
      slot_of_entry[i] = static_cast<std::uint32_t>(s);
    }
    std::uint32_t next = 0;
    std::vector<bool> placed(slots_.size(), false);
    for (const std::uint32_t s : slot_of_entry) {  // ranges in the order in which cells were first met
      if (placed[s]) continue;
      placed[s] = true;
      const std::uint32_t count = slots_[s].range.end;
      slots_[s].range = {next, next};
      next += count;
    }
    order.resize(keys.size());
    for (std::uint32_t i = 0; i < keys.size(); ++i) order[slots_[slot_of_entry[i]].range.end++] = i;
  }
  /// An empty range when the cell holds nothing.
  [[nodiscard]] CellRange find(CellKey key) const {
    if (slots_.empty()) return {};
    for (std::size_t s = slot(key); slots_[s].range.end != 0; s = (s + 1) & (slots_.size() - 1))
      if (slots_[s].key == key) return slots_[s].range;
    return {};
  }

 private:
  struct Slot {
    CellKey key = 0;
    CellRange range;  // end == 0: free (a used range is never empty)
  };
  [[nodiscard]] std::size_t slot(CellKey key) const {  // finaliser of SplitMix64 (Steele, Lea, Flood 2014)
    key = (key ^ (key >> 30)) * 0xBF58476D1CE4E5B9ULL;
    key = (key ^ (key >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<std::size_t>(key ^ (key >> 31)) & (slots_.size() - 1);
  }
  std::vector<Slot> slots_;
};

}  // namespace isthmus::congruent
