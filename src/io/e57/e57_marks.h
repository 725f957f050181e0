// Places in a scan's packets from which any record is found quickly. E57 has no such table that writers fill reliably.
#pragma once

#include <vector>

#include "io/e57/e57_columns.h"

namespace isthmus::io {

class E57Marks {
 public:
  /// Goes once over the headers of the packets, up to those that complete `num_records` records of all columns. Fails
  /// if there are fewer.
  static Result<E57Marks> walk(E57Packets& packets, E57Columns& columns, std::uint64_t num_records);

  /// Sets all columns to a record.
  Result<void> seek(E57Columns& columns, E57Packets& packets, std::uint64_t record) const;

 private:
  /// Bytes before a packet, of each column's bytestream.
  struct Mark {
    std::uint64_t packet = 0;  // logical offset
    std::vector<std::uint64_t> bytes_before;
  };

  void add(Mark mark);

  std::vector<Mark> marks_;
  std::size_t packets_per_mark_ = 1;
  std::size_t num_packets_ = 0;
};

}  // namespace isthmus::io
