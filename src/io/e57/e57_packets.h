// The compressed vector section of an E57 scan: packets, and in the data packets a piece of each field's bytestream.
//
//   section header   uint8 id = 1, 7 reserved, uint64 length of the section in data bytes, uint64 physical offset of
//   the
//                    first data packet, uint64 physical offset of the first index packet (0 = none)
//   data packet      uint8 type = 1, uint8 flags, uint16 length - 1, uint16 number n of bytestreams, n uint16 lengths,
//                    then the n pieces one after the other, filled up to a multiple of 4
//   index packet     uint8 type = 0, uint8, uint16 length - 1, ...     passed over
//   empty packet     uint8 type = 2, uint8, uint16 length - 1, ...     passed over
//
// The pieces of a field in all packets, one after the other, are its bytestream. The packets need not end at the same
// record in all fields. Source: ASTM E2807-11, section 9.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "io/e57/e57_pages.h"

namespace isthmus::io {

inline constexpr std::uint8_t kE57IndexPacket = 0, kE57DataPacket = 1, kE57EmptyPacket = 2;
inline constexpr std::uint8_t kE57SectionId = 1;
inline constexpr std::size_t kE57SectionHeaderBytes = 32;
inline constexpr std::size_t kE57MostPacketBytes = 0x10000;

/// Where the packets lie, logical offsets.
struct E57Section {
  std::uint64_t begin = 0, end = 0;
};

Result<E57Section> read_e57_section(E57Pages& pages, std::uint64_t section_physical, const std::string& where);

struct E57Packet {
  std::uint64_t begin = 0, next = 0;   ///< logical offsets of this packet and of the one behind it
  std::vector<std::size_t> piece_end;  ///< of each bytestream, from the packet's first byte
  std::size_t pieces_begin = 0;

  [[nodiscard]] std::size_t piece_begin(std::size_t stream) const {
    return stream == 0 ? pieces_begin : piece_end[stream - 1];
  }
  [[nodiscard]] std::size_t piece_bytes(std::size_t stream) const { return piece_end[stream] - piece_begin(stream); }
};

/// A data packet with its bytes.
struct E57LoadedPacket : E57Packet {
  std::vector<char> bytes;
};

/// Finds packets by offset. The fields of a scan read the same packets at slightly different times, so that the last
/// few are kept.
class E57Packets {
 public:
  E57Packets(E57Pages pages, const E57Section& section, std::size_t num_streams)
      : pages_(std::move(pages)), section_(section), num_streams_(num_streams) {}

  [[nodiscard]] const E57Section& section() const { return section_; }
  [[nodiscard]] const std::string& name() const { return pages_.name(); }

  /// The first data packet at or behind `place`, which is where a packet begins; null at the end of the section. Valid
  /// until the next call.
  Result<const E57LoadedPacket*> load(std::uint64_t place);

  /// The same without the bytes; false at the end.
  Result<bool> look(std::uint64_t place, E57Packet& packet);

 private:
  static constexpr std::size_t kKept = 4;
  struct Kept {
    std::uint64_t asked_at = ~std::uint64_t{0};
    std::uint64_t last_use = 0;
    E57LoadedPacket packet;
  };

  Result<void> look_at_data(std::uint64_t place, std::size_t length, E57Packet& packet);
  [[nodiscard]] tl::unexpected<Error> bad_packet(std::uint64_t place, std::string what) const;

  E57Pages pages_;
  E57Section section_;
  std::size_t num_streams_;
  std::array<Kept, kKept> kept_;
  std::uint64_t num_uses_ = 0;
};

}  // namespace isthmus::io
