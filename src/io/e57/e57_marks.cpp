#include "io/e57/e57_marks.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kMostMarks = 4096;  // whatever the size of the file; some packets are looked at from each

}  // namespace

void E57Marks::add(Mark mark) {
  if (num_packets_++ % packets_per_mark_ != 0) return;
  marks_.push_back(std::move(mark));
  if (marks_.size() < kMostMarks) return;
  for (std::size_t i = 1; 2 * i < marks_.size(); ++i) marks_[i] = std::move(marks_[2 * i]);
  marks_.resize((marks_.size() + 1) / 2);
  packets_per_mark_ *= 2;
}

Result<E57Marks> E57Marks::walk(E57Packets& packets, E57Columns& columns, std::uint64_t num_records) {
  std::vector<std::size_t> streams;
  std::vector<std::uint64_t> needed;
  columns.each_stream([&](const E57Stream& stream) {
    streams.push_back(stream.stream());
    needed.push_back(stream.bytes_of(num_records));
  });
  E57Marks marks;
  Mark mark = {packets.section().begin, std::vector<std::uint64_t>(streams.size(), 0)};
  const auto complete = [&] {
    return std::equal(needed.begin(), needed.end(), mark.bytes_before.begin(), std::less_equal<>());
  };
  E57Packet packet;
  do {
    marks.add(mark);
    if (complete()) break;
    auto found = packets.look(mark.packet, packet);
    if (!found) return tl::unexpected(std::move(found.error()));
    if (!*found) {
      return fail("the points end early: the XML says more than the section holds",
                  at_byte(packets.name(), e57_physical(packets.section().end)), "the file is damaged: export it again");
    }
    for (std::size_t s = 0; s < streams.size(); ++s) mark.bytes_before[s] += packet.piece_bytes(streams[s]);
    mark.packet = packet.next;
  } while (!complete());
  return marks;
}

Result<void> E57Marks::seek(E57Columns& columns, E57Packets& packets, std::uint64_t record) const {
  Result<void> result;
  std::size_t s = 0;
  columns.each_stream([&](E57Stream& stream) {
    const std::uint64_t byte = stream.first_byte_of(record);
    const auto behind =
        std::upper_bound(marks_.begin(), marks_.end(), byte,
                         [&](std::uint64_t value, const Mark& mark) { return value < mark.bytes_before[s]; });
    const Mark& mark = *std::prev(behind);  // the first one has no bytes before it
    if (result) result = stream.seek(packets, mark.packet, mark.bytes_before[s], record);
    ++s;
  });
  return result;
}

}  // namespace isthmus::io
