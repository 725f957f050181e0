// The pages of an E57 file: 1024 bytes, 1020 of data and behind them the CRC-32C of these (big-endian).
//
// "Physical" offsets count all bytes of the file, "logical" ones only the data:
// physical = logical / 1020 * 1024 + logical % 1020. Source: ASTM E2807-11, sections 6 and 7.
#pragma once

#include <algorithm>
#include <bitset>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/input_file.h"

namespace isthmus::io {

inline constexpr std::uint64_t kE57PageBytes = 1024;
inline constexpr std::uint64_t kE57PageData = 1020;

constexpr std::uint64_t e57_physical(std::uint64_t logical) {
  return logical / kE57PageData * kE57PageBytes + logical % kE57PageData;
}

/// Precondition: the offset is not within a checksum, physical % 1024 < 1020.
constexpr std::uint64_t e57_logical(std::uint64_t physical) {
  return physical / kE57PageBytes * kE57PageData + physical % kE57PageBytes;
}

/// CRC-32C (Castagnoli, polynomial 0x1EDC6F41, reflected), eight bytes a step by tables (Kounavis, Berry 2005).
std::uint32_t crc32c(std::string_view bytes);

/// Reads data bytes by their logical offset and checks each page that is touched. Memory: one block of pages.
class E57Pages {
 public:
  /// The whole pages of the file's first `physical_size` bytes.
  E57Pages(InputFile file, std::uint64_t physical_size)
      : file_(std::move(file)), num_pages_(physical_size / kE57PageBytes) {}

  /// Leaves out the pages from there on.
  void end_at(std::uint64_t physical_size) { num_pages_ = std::min(num_pages_, physical_size / kE57PageBytes); }

  [[nodiscard]] const std::string& name() const { return file_.name(); }
  [[nodiscard]] std::uint64_t logical_size() const { return num_pages_ * kE57PageData; }

  /// Exactly n data bytes; an error if the file ends before or a page on the way is damaged.
  Result<void> read(std::uint64_t logical, void* out, std::size_t n);

 private:
  static constexpr std::size_t kPagesPerBlock = 64;

  Result<void> load(std::uint64_t page, std::size_t wanted_pages);
  Result<void> check(std::size_t page_in_block);

  InputFile file_;
  std::uint64_t num_pages_;
  std::vector<char> block_;  // pages [first_page_, first_page_ + pages_in_block_)
  std::uint64_t first_page_ = 0;
  std::size_t pages_in_block_ = 0;
  std::bitset<kPagesPerBlock> checked_;
};

}  // namespace isthmus::io
