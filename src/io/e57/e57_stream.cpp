#include "io/e57/e57_stream.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "io/wording.h"

namespace isthmus::io {
namespace {

template <class T>
T load(const char* place) {
  T value;
  std::memcpy(&value, place, sizeof(T));
  return value;
}

}  // namespace

std::uint64_t E57Stream::first_byte_of(std::uint64_t record) const {
  return static_cast<std::uint64_t>(static_cast<unsigned __int128>(record) * field_.bits / 8);
}

std::uint64_t E57Stream::bytes_of(std::uint64_t records) const {
  return static_cast<std::uint64_t>((static_cast<unsigned __int128>(records) * field_.bits + 7) / 8);
}

Result<void> E57Stream::refill(E57Packets& packets) {
  const std::size_t whole_bytes = std::min(next_bit_ / 8, num_bytes_);
  std::memmove(bytes_.data(), bytes_.data() + whole_bytes, num_bytes_ - whole_bytes);
  num_bytes_ -= whole_bytes;
  next_bit_ -= whole_bytes * 8;
  auto packet = packets.load(next_packet_);
  if (!packet) return tl::unexpected(std::move(packet.error()));
  if (*packet == nullptr) {
    return fail(fmt::format("the points end early: '{}' has {} records, the XML says more", field_.name, num_read_),
                at_byte(packets.name(), e57_physical(packets.section().end)), "the file is damaged: export it again");
  }
  const std::size_t length = (*packet)->piece_bytes(stream_);
  bytes_.resize(num_bytes_ + length + kRoomBytes);
  std::memcpy(bytes_.data() + num_bytes_, (*packet)->bytes.data() + (*packet)->piece_begin(stream_), length);
  num_bytes_ += length;
  next_packet_ = (*packet)->next;
  return {};
}

// Records lie bit behind bit, the lowest bit of the lowest byte first.
void E57Stream::decode(std::size_t n, double* out) const {
  const unsigned bits = field_.bits;
  const double scale = field_.scale, offset = field_.offset;
  const auto minimum = static_cast<std::uint64_t>(field_.minimum);
  const auto value_of = [&](std::uint64_t stored) {
    return static_cast<double>(static_cast<std::int64_t>(minimum + stored)) * scale + offset;
  };
  const char* const aligned = bytes_.data() + next_bit_ / 8;
  if (field_.kind == E57FieldKind::float32) {
    for (std::size_t i = 0; i < n; ++i) out[i] = static_cast<double>(load<float>(aligned + 4 * i));
  } else if (field_.kind == E57FieldKind::float64) {
    std::memcpy(out, aligned, n * sizeof(double));
  } else if (bits == 0) {
    std::fill(out, out + n, value_of(0));
  } else if (bits == 32 && next_bit_ % 8 == 0) {
    for (std::size_t i = 0; i < n; ++i) out[i] = value_of(load<std::uint32_t>(aligned + 4 * i));
  } else {
    const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
    std::size_t bit = next_bit_;
    for (std::size_t i = 0; i < n; ++i, bit += bits) {
      const char* const place = bytes_.data() + bit / 8;
      const auto shift = static_cast<unsigned>(bit % 8);
      std::uint64_t stored = load<std::uint64_t>(place) >> shift;
      if (shift + bits > 64) stored |= static_cast<std::uint64_t>(load<std::uint8_t>(place + 8)) << (64 - shift);
      out[i] = value_of(stored & mask);
    }
  }
}

Result<void> E57Stream::read(E57Packets& packets, std::size_t n, double* out) {
  const std::size_t bits = field_.bits;
  while (n > 0) {
    const std::size_t bits_left = num_bytes_ * 8 - std::min(num_bytes_ * 8, next_bit_);
    const std::size_t ready = bits == 0 ? n : std::min(n, bits_left / bits);
    if (ready > 0) decode(ready, out);
    next_bit_ += ready * bits;
    num_read_ += ready;
    out += ready;
    n -= ready;
    if (n == 0) break;
    if (auto refilled = refill(packets); !refilled) return refilled;
  }
  return {};
}

Result<void> E57Stream::seek(E57Packets& packets, std::uint64_t packet_place, std::uint64_t bytes_before,
                             std::uint64_t record) {
  num_bytes_ = next_bit_ = 0;
  num_read_ = record;
  next_packet_ = packet_place;
  if (field_.bits == 0) return {};
  const std::uint64_t byte = first_byte_of(record);
  for (E57Packet packet;; bytes_before += packet.piece_bytes(stream_), next_packet_ = packet.next) {
    auto found = packets.look(next_packet_, packet);
    if (!found) return tl::unexpected(std::move(found.error()));
    if (!*found || bytes_before + packet.piece_bytes(stream_) > byte) break;  // at the end reading says what is missing
  }
  const auto skipped_bits = static_cast<unsigned>(static_cast<unsigned __int128>(record) * field_.bits % 8);
  next_bit_ = static_cast<std::size_t>(byte - bytes_before) * 8 + skipped_bits;
  return {};
}

}  // namespace isthmus::io
