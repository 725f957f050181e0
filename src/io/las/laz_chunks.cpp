#include "io/las/laz_chunks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <vector>

#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kRecordHeaderBytes = 54;
constexpr std::string_view kLaszipUser = "laszip encoded";
constexpr std::uint16_t kLaszipId = 22204;
constexpr std::size_t kPayloadBytes = 34, kItemBytes = 6;
constexpr const char* kCutShort = "the file is cut short or damaged: export it again";

enum Compressor : std::uint16_t { kPointwise = 1, kChunked = 2, kLayered = 3 };  // LASZIP_COMPRESSOR_...

template <class T>
T at(const std::vector<char>& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

Result<std::vector<char>> bytes_of_file(const InputFile& file, std::uint64_t offset, std::size_t count) {
  std::vector<char> bytes(count);
  if (offset > file.size() || count > file.size() - offset)
    return fail(fmt::format("{} bytes are missing", count), at_byte(file.name(), std::min(offset, file.size())),
                kCutShort);
  if (auto read = file.read_at(offset, bytes.data(), count); !read) return tl::unexpected(std::move(read.error()));
  return bytes;
}

struct Payload {
  std::uint64_t begin = 0;
  std::vector<char> bytes;
};

/// LASzip's own record among those of variable length.
Result<Payload> find_record(const InputFile& file, const LasHeader& las) {
  std::uint64_t place = las.header_bytes;
  if (las.num_records > (las.points_begin - place) / kRecordHeaderBytes) {
    return fail(fmt::format("the header says {} variable length records, there is room for {}", las.num_records,
                            (las.points_begin - place) / kRecordHeaderBytes),
                at_byte(file.name(), 100), kCutShort);
  }
  for (std::uint32_t k = 0; k < las.num_records; ++k) {
    const auto head = bytes_of_file(file, place, kRecordHeaderBytes);
    if (!head) return tl::unexpected(head.error());
    const std::size_t length = at<std::uint16_t>(*head, 20);
    const std::uint64_t begin = place + kRecordHeaderBytes;
    if (begin + length > las.points_begin) {
      return fail(fmt::format("variable length record {} of {} bytes reaches into the points", k, length),
                  at_byte(file.name(), place), kCutShort);
    }
    const std::string_view user(head->data() + 2, 16);
    if (user.substr(0, user.find('\0')) == kLaszipUser && at<std::uint16_t>(*head, 18) == kLaszipId) {
      auto payload = bytes_of_file(file, begin, length);
      if (!payload) return tl::unexpected(payload.error());
      return Payload{begin, std::move(*payload)};
    }
    place = begin + length;
  }
  return fail("the points are compressed, but the record of LASzip that says how is missing",
              at_byte(file.name(), las.header_bytes), kCutShort);
}

struct Item {
  std::uint16_t type, bytes, oldest_version, newest_version;
};

/// What a point of the header's format consists of (LASitem::Type).
std::vector<Item> items_of(const LasHeader& las) {
  const Item point10{6, 20, 1, 2}, time{7, 8, 1, 2}, rgb12{8, 6, 1, 2}, wave13{9, 29, 1, 1};
  const Item point14{10, 30, 2, 4}, rgb14{11, 6, 2, 4}, rgbnir14{12, 8, 2, 4}, wave14{13, 29, 3, 4};
  const std::array<std::vector<Item>, 11> formats = {{{point10},
                                                      {point10, time},
                                                      {point10, rgb12},
                                                      {point10, time, rgb12},
                                                      {point10, time, wave13},
                                                      {point10, time, rgb12, wave13},
                                                      {point14},
                                                      {point14, rgb14},
                                                      {point14, rgbnir14},
                                                      {point14, wave14},
                                                      {point14, rgbnir14, wave14}}};
  std::vector<Item> items = formats[las.format];
  const auto extra = static_cast<std::uint16_t>(las.record_bytes - las.point_format().bytes);
  const bool old = las.format < 6;
  if (extra > 0)
    items.push_back({static_cast<std::uint16_t>(old ? 0 : 14), extra, static_cast<std::uint16_t>(old ? 1 : 2),
                     static_cast<std::uint16_t>(old ? 2 : 4)});
  return items;
}

Result<void> check_record(const InputFile& file, const LasHeader& las, const Payload& payload) {
  const std::string where = at_byte(file.name(), payload.begin);
  const std::vector<Item> items = items_of(las);
  if (payload.bytes.size() != kPayloadBytes + kItemBytes * items.size() ||
      at<std::uint16_t>(payload.bytes, 32) != items.size()) {
    return fail(fmt::format("the record of LASzip does not describe points of format {} with {} bytes", las.format,
                            las.record_bytes),
                where, kCutShort);
  }
  for (std::size_t k = 0; k < items.size(); ++k) {
    const std::size_t item = kPayloadBytes + kItemBytes * k;
    const auto version = at<std::uint16_t>(payload.bytes, item + 4);
    if (at<std::uint16_t>(payload.bytes, item) != items[k].type ||
        at<std::uint16_t>(payload.bytes, item + 2) != items[k].bytes) {
      return fail(fmt::format("the record of LASzip does not describe points of format {} with {} bytes", las.format,
                              las.record_bytes),
                  at_byte(file.name(), payload.begin + item), kCutShort);
    }
    if (version < items[k].oldest_version || version > items[k].newest_version)
      return fail(fmt::format("unsupported format: version {} of compressed points", version),
                  at_byte(file.name(), payload.begin + item + 4));
  }
  const auto compressor = at<std::uint16_t>(payload.bytes, 0);
  const bool fits = las.format < 6 ? compressor == kPointwise || compressor == kChunked : compressor == kLayered;
  if (!fits || at<std::uint16_t>(payload.bytes, 2) != 0) {
    return fail(fmt::format("unsupported format: LASzip's compressor {} with point format {}", compressor, las.format),
                where);
  }
  return {};
}

/// Where the table of chunks begins.
Result<std::uint64_t> table_place(const InputFile& file, const LasHeader& las) {
  auto place = bytes_of_file(file, las.points_begin, sizeof(std::int64_t));
  if (!place) return tl::unexpected(place.error());
  if (at<std::int64_t>(*place, 0) == -1) place = bytes_of_file(file, file.size() - 8, 8);
  if (!place) return tl::unexpected(place.error());
  const auto begin = at<std::uint64_t>(*place, 0);
  if (begin == las.points_begin)
    return fail("the table of chunks was never written", at_byte(file.name(), las.points_begin),
                "the program that wrote the file was interrupted: export it again");
  if (begin < las.points_begin + 8 || begin > file.size() || file.size() - begin < 8) {
    return fail(fmt::format("the table of chunks should be at byte {}, the file holds {}", begin, file.size()),
                at_byte(file.name(), las.points_begin), kCutShort);
  }
  return begin;
}

}  // namespace

Result<LazChunks> read_laz_chunks(const InputFile& file, const LasHeader& las) {
  const auto payload = find_record(file, las);
  if (!payload) return tl::unexpected(payload.error());
  if (auto good = check_record(file, las, *payload); !good) return tl::unexpected(good.error());
  if (at<std::uint16_t>(payload->bytes, 0) == kPointwise) return LazChunks{1, las.num_points};
  const auto begin = table_place(file, las);
  if (!begin) return tl::unexpected(begin.error());
  const auto table = bytes_of_file(file, *begin, 8);
  if (!table) return tl::unexpected(table.error());
  LazChunks chunks;
  chunks.count = at<std::uint32_t>(*table, 4);
  const auto size = at<std::int32_t>(payload->bytes, 12);
  chunks.points_per_chunk = size > 0 ? static_cast<std::uint64_t>(size) : 0;
  const std::string where = at_byte(file.name(), *begin);
  // A chunk begins with its first point as it is.
  const std::uint64_t most = (*begin - las.points_begin) / las.point_format().bytes;
  if (at<std::uint32_t>(*table, 0) != 0 || chunks.count == 0 || chunks.count > most)
    return fail(fmt::format("the table of chunks is damaged: {} chunks", chunks.count), where, kCutShort);
  if (chunks.points_per_chunk > 0 && las.num_points > chunks.count * chunks.points_per_chunk) {
    return fail(fmt::format("the header says {} points, the file holds {} chunks of {}", las.num_points, chunks.count,
                            chunks.points_per_chunk),
                where, kCutShort);
  }
  return chunks;
}

}  // namespace isthmus::io
