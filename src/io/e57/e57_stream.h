// One field of an E57 scan as a sequence of numbers.
#pragma once

#include <vector>

#include "io/e57/e57_packets.h"
#include "io/e57/e57_scan.h"

namespace isthmus::io {

class E57Stream {
 public:
  /// `stream` is the field's place among the bytestreams. Starts at record 0.
  E57Stream(const E57Field& field, std::size_t stream, const E57Section& section)
      : field_(field), stream_(stream), next_packet_(section.begin), bytes_(kRoomBytes) {}

  /// The next n values; an error if the section ends before.
  Result<void> read(E57Packets& packets, std::size_t n, double* out);

  /// Goes to a record, looking from the packet at `packet` on, before which lie `bytes_before` bytes of this
  /// bytestream. Precondition: the record's first byte is not among them.
  Result<void> seek(E57Packets& packets, std::uint64_t packet, std::uint64_t bytes_before, std::uint64_t record);

  [[nodiscard]] std::size_t stream() const { return stream_; }
  /// Bytes that the first `records` records take, the last one begun.
  [[nodiscard]] std::uint64_t bytes_of(std::uint64_t records) const;
  /// Bytes of the bytestream before the one in which a record begins.
  [[nodiscard]] std::uint64_t first_byte_of(std::uint64_t record) const;

 private:
  static constexpr std::size_t kRoomBytes = 16;  // a record may begin in the last byte and is loaded as 9 bytes

  Result<void> refill(E57Packets& packets);
  void decode(std::size_t n, double* out) const;

  E57Field field_;
  std::size_t stream_;
  std::uint64_t next_packet_;
  std::vector<char> bytes_;     // unread bytes of the bytestream, then kRoomBytes to read over the end
  std::size_t num_bytes_ = 0;   // without that room
  std::size_t next_bit_ = 0;    // of the next record, from bytes_[0]
  std::uint64_t num_read_ = 0;  // records, for messages
};

}  // namespace isthmus::io
