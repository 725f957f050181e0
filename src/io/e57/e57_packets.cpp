#include "io/e57/e57_packets.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "io/e57/e57_file.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kPacketStart = 4;      // type, flags, length - 1
constexpr std::size_t kDataPacketStart = 6;  // and the number of bytestreams

template <class T>
T at(const char* bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes + offset, sizeof(T));
  return value;
}

}  // namespace

Result<E57Section> read_e57_section(E57Pages& pages, std::uint64_t section_physical, const std::string& where) {
  const std::uint64_t file_end = pages.logical_size();
  const auto outside = [&](std::uint64_t physical) {
    return physical % kE57PageBytes >= kE57PageData || physical < kE57HeaderBytes || e57_logical(physical) >= file_end;
  };
  if (outside(section_physical)) {
    return fail(fmt::format("its points cannot begin at byte {}", section_physical), where);
  }
  const std::uint64_t begin = e57_logical(section_physical);
  std::array<char, kE57SectionHeaderBytes> raw = {};
  if (auto read = pages.read(begin, raw.data(), raw.size()); !read) return tl::unexpected(std::move(read.error()));
  const std::string place = at_byte(pages.name(), section_physical);
  if (at<std::uint8_t>(raw.data(), 0) != kE57SectionId) {
    return fail(fmt::format("no section of points begins here: id {} instead of {}", at<std::uint8_t>(raw.data(), 0),
                            kE57SectionId),
                place);
  }
  const auto length = at<std::uint64_t>(raw.data(), 8), data = at<std::uint64_t>(raw.data(), 16);
  if (length < raw.size() || length > file_end - begin) {
    return fail(fmt::format("a section of points cannot have {} bytes", length), place);
  }
  if (outside(data) || e57_logical(data) < begin + raw.size() || e57_logical(data) > begin + length) {
    return fail(fmt::format("the points of a section cannot begin at byte {}", data), place);
  }
  return E57Section{e57_logical(data), begin + length};
}

tl::unexpected<Error> E57Packets::bad_packet(std::uint64_t place, std::string what) const {
  return fail(std::move(what), at_byte(pages_.name(), e57_physical(place)));
}

Result<void> E57Packets::look_at_data(std::uint64_t place, std::size_t length, E57Packet& packet) {
  std::uint16_t num_streams = 0;
  packet.begin = place;
  packet.next = place + length;
  packet.pieces_begin = kDataPacketStart + num_streams_ * sizeof(std::uint16_t);
  if (length < packet.pieces_begin) {
    return bad_packet(place, fmt::format("a data packet of {} bytes has no room for {} fields", length, num_streams_));
  }
  if (auto read = pages_.read(place + kPacketStart, &num_streams, sizeof num_streams); !read) return read;
  if (num_streams != num_streams_) {
    return bad_packet(place, fmt::format("a data packet with {} fields, the XML names {}", num_streams, num_streams_));
  }
  std::vector<std::uint16_t> lengths(num_streams_);
  auto read = pages_.read(place + kDataPacketStart, lengths.data(), lengths.size() * sizeof(std::uint16_t));
  if (!read) return read;
  packet.piece_end.resize(num_streams_);
  std::size_t end = packet.pieces_begin;
  for (std::size_t s = 0; s < num_streams_; ++s) packet.piece_end[s] = end += lengths[s];
  if (end > length) {
    return bad_packet(place, fmt::format("the fields of a data packet have {} bytes, the packet {}", end, length));
  }
  return {};
}

Result<bool> E57Packets::look(std::uint64_t place, E57Packet& packet) {
  while (place < section_.end) {
    std::array<char, kPacketStart> start = {};
    if (section_.end - place < start.size()) break;
    if (auto read = pages_.read(place, start.data(), start.size()); !read) return tl::unexpected(read.error());
    const auto type = at<std::uint8_t>(start.data(), 0);
    const std::size_t length = std::size_t{at<std::uint16_t>(start.data(), 2)} + 1;
    if (type > kE57EmptyPacket) return bad_packet(place, fmt::format("no packet of points begins here: type {}", type));
    if (length < start.size() || length > section_.end - place) {
      return bad_packet(place, fmt::format("a packet cannot have {} bytes here", length));
    }
    if (type == kE57DataPacket) {
      auto looked = look_at_data(place, length, packet);
      if (!looked) return tl::unexpected(std::move(looked.error()));
      return true;
    }
    place += length;
  }
  return false;
}

Result<const E57LoadedPacket*> E57Packets::load(std::uint64_t place) {
  const auto known = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.asked_at == place; });
  if (known != kept_.end()) {
    known->last_use = ++num_uses_;
    return &known->packet;
  }
  Kept& oldest = *std::min_element(kept_.begin(), kept_.end(),
                                   [](const Kept& a, const Kept& b) { return a.last_use < b.last_use; });
  oldest.asked_at = ~std::uint64_t{0};
  auto found = look(place, oldest.packet);
  if (!found) return tl::unexpected(std::move(found.error()));
  if (!*found) return nullptr;
  E57LoadedPacket& packet = oldest.packet;
  packet.bytes.resize(static_cast<std::size_t>(packet.next - packet.begin));
  auto read = pages_.read(packet.begin, packet.bytes.data(), packet.bytes.size());
  if (!read) return tl::unexpected(std::move(read.error()));
  oldest.asked_at = place;
  oldest.last_use = ++num_uses_;
  return &packet;
}

}  // namespace isthmus::io
