#include "io/e57/e57_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "io/wording.h"

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are read in this machine's byte order");

using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;

// tables[k][b]: what the byte b does to the remainder k bytes further on.
constexpr CrcTables crc_tables() {
  constexpr std::uint32_t kReflectedPolynomial = 0x82F63B78;
  CrcTables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? kReflectedPolynomial : 0);
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < 8; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = (before >> 8) ^ tables[0][before & 0xFF];
    }
  }
  return tables;
}

constexpr CrcTables kCrc = crc_tables();

std::uint32_t stored_checksum(const char* page) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(page[kE57PageData + i]);
  return value;
}

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  std::uint32_t crc = ~0U;
  const char* place = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= 8; left -= 8, place += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, place, 8);
    word ^= crc;
    crc = kCrc[7][word & 0xFF] ^ kCrc[6][word >> 8 & 0xFF] ^ kCrc[5][word >> 16 & 0xFF] ^ kCrc[4][word >> 24 & 0xFF] ^
          kCrc[3][word >> 32 & 0xFF] ^ kCrc[2][word >> 40 & 0xFF] ^ kCrc[1][word >> 48 & 0xFF] ^ kCrc[0][word >> 56];
  }
  for (; left > 0; --left, ++place) crc = (crc >> 8) ^ kCrc[0][(crc ^ static_cast<unsigned char>(*place)) & 0xFF];
  return ~crc;
}

// Reads ahead only where the reading goes on at the next page, so that a look at a few places stays cheap.
Result<void> E57Pages::load(std::uint64_t page, std::size_t wanted_pages) {
  const bool goes_on = page == first_page_ + pages_in_block_;
  const std::size_t pages = std::min(goes_on ? kPagesPerBlock : wanted_pages, kPagesPerBlock);
  const auto available = static_cast<std::size_t>(std::min<std::uint64_t>(pages, num_pages_ - page));
  block_.resize(kPagesPerBlock * kE57PageBytes);
  pages_in_block_ = 0;
  if (auto read = file_.read_at(page * kE57PageBytes, block_.data(), available * kE57PageBytes); !read) return read;
  first_page_ = page;
  pages_in_block_ = available;
  checked_.reset();
  return {};
}

Result<void> E57Pages::check(std::size_t page_in_block) {
  if (checked_[page_in_block]) return {};
  const char* const page = block_.data() + page_in_block * kE57PageBytes;
  const std::uint32_t stored = stored_checksum(page), computed = crc32c({page, kE57PageData});
  if (stored != computed) {
    const std::uint64_t number = first_page_ + page_in_block;
    return fail(
        fmt::format("page {} is damaged: its checksum is {:08x}, its bytes give {:08x}", number, stored, computed),
        at_byte(file_.name(), number * kE57PageBytes), "copy or export the file again");
  }
  checked_.set(page_in_block);
  return {};
}

Result<void> E57Pages::read(std::uint64_t logical, void* out, std::size_t n) {
  if (logical > logical_size() || n > logical_size() - logical) {
    return fail(fmt::format("the file ends, {} more bytes were expected", n),
                at_byte(file_.name(), e57_physical(std::min(logical, logical_size()))));
  }
  auto* to = static_cast<char*>(out);
  while (n > 0) {
    const std::uint64_t page = logical / kE57PageData;
    const auto in_page = static_cast<std::size_t>(logical % kE57PageData);
    if (page < first_page_ || page >= first_page_ + pages_in_block_) {
      if (auto loaded = load(page, (in_page + n + kE57PageData - 1) / kE57PageData); !loaded) return loaded;
    }
    const auto page_in_block = static_cast<std::size_t>(page - first_page_);
    if (auto good = check(page_in_block); !good) return good;
    const std::size_t length = std::min<std::size_t>(n, kE57PageData - in_page);
    std::memcpy(to, block_.data() + page_in_block * kE57PageBytes + in_page, length);
    to += length;
    logical += length;
    n -= length;
  }
  return {};
}

}  // namespace isthmus::io
