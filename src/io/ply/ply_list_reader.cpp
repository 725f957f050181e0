#include "io/ply/ply_list_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/local_origin.h"
#include "io/ply/ply_reader.h"
#include "io/record_reader.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

std::uint64_t list_length(const char* bytes, ScalarType type, bool swap_bytes) {
  const std::size_t size = bytes_of(type);
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < size; ++i) {  // most significant byte first
    length = length << 8 | static_cast<unsigned char>(bytes[swap_bytes ? i : size - 1 - i]);
  }
  return length;
}

tl::unexpected<Error> cut_short(const InputFile& file, const PlyElement& element, std::uint64_t done) {
  return fail(fmt::format("the header says {} elements '{}', the file holds {}", element.count, element.name, done),
              at_byte(file.name(), file.size()), "the file is cut short or its header is wrong: export it again");
}

Result<bool> skip_bytes(InputFile& file, std::uint64_t bytes) {
  if (bytes > file.size() - std::min(file.size(), file.offset())) return false;
  file.seek(file.offset() + bytes);
  return true;
}

// Moves over one element. The values of its scalar properties go to `scalars`, one after the other, if given. False
// when the file ends inside the element.
Result<bool> walk_element(InputFile& file, const PlyElement& element, bool swap_bytes, std::vector<char>* scalars) {
  for (const PlyProperty& property : element.properties) {
    const std::size_t head = bytes_of(property.list_count_type.value_or(property.type));
    auto bytes = file.peek(head);
    if (!bytes) return tl::unexpected(std::move(bytes.error()));
    if (bytes->size() < head) return false;
    if (!property.list_count_type) {
      if (scalars != nullptr) scalars->insert(scalars->end(), bytes->data(), bytes->data() + head);
      file.consume(head);
      continue;
    }
    const std::uint64_t length = list_length(bytes->data(), *property.list_count_type, swap_bytes);
    file.consume(head);
    if (length > file.size()) return false;
    auto skipped = skip_bytes(file, length * bytes_of(property.type));
    if (!skipped || !*skipped) return skipped;
  }
  return true;
}

// The scalar properties of the vertices, gathered into records of one size.
PlyElement without_lists(const PlyElement& vertex) {
  PlyElement scalars = vertex;
  std::erase_if(scalars.properties, [](const PlyProperty& p) { return p.list_count_type.has_value(); });
  return scalars;
}

class PlyListReader final : public ProbingReader {
 public:
  PlyListReader(InputFile file, ScanHeader header, const PlyElement& vertex, bool swap_bytes)
      : file_(std::move(file)), header_(std::move(header)), vertex_(vertex), begin_byte_(file_.offset()) {
    layout_ = ply_vertex_layout(without_lists(vertex), swap_bytes);
  }
  [[nodiscard]] const ScanHeader& header() const override { return header_; }

  Result<void> read(PointChunk& chunk, std::size_t max_points) override {
    chunk.clear();
    auto records = gather(max_points);
    if (!records) return tl::unexpected(std::move(records.error()));
    append_records(layout_, records->data(), 0, records->size() / layout_.bytes_per_record,
                   header_.local_origin_in_scan, chunk);
    return {};
  }

  // Walks over all vertices (where one lies is known only from those before it) and keeps evenly spread ones.
  Result<PointChunk> probe(std::size_t max_points) override {
    const std::uint64_t place = file_.offset();
    const std::uint64_t num_read = std::exchange(num_read_, 0);
    file_.seek(begin_byte_);
    auto records =
        gather(vertex_.count, std::max<std::uint64_t>(1, vertex_.count / std::max<std::size_t>(1, max_points)));
    file_.seek(place);
    num_read_ = num_read;
    if (!records) return tl::unexpected(std::move(records.error()));
    PointChunk chunk;
    append_records(layout_, records->data(), 0, records->size() / layout_.bytes_per_record,
                   header_.local_origin_in_scan, chunk);
    return chunk;
  }

  Result<void> choose_from_sample() {
    auto records = gather(kOpeningSample);
    if (!records) return tl::unexpected(std::move(records.error()));
    const std::size_t n = records->size() / layout_.bytes_per_record;
    choose_colour_scale(layout_, records->data(), n);
    header_.local_origin_in_scan = local_origin_of(positions_of_records(layout_, records->data(), 0, n));
    header_.has_intensity = layout_.intensity.has_value();
    header_.has_colour = layout_.colour.has_value();
    file_.seek(begin_byte_);
    num_read_ = 0;
    return {};
  }

 private:
  // Walks over the next `max_records` vertices and keeps the scalars of every `stride`-th.
  Result<std::vector<char>> gather(std::uint64_t max_records, std::uint64_t stride = 1) {
    std::vector<char> records;
    for (std::uint64_t n = 0; n < max_records && num_read_ < vertex_.count; ++n, ++num_read_) {
      auto whole = walk_element(file_, vertex_, layout_.swap_bytes, n % stride == 0 ? &records : nullptr);
      if (!whole) return tl::unexpected(std::move(whole.error()));
      if (!*whole) return cut_short(file_, vertex_, num_read_);
    }
    return records;
  }

  InputFile file_;
  ScanHeader header_;
  PlyElement vertex_;
  RecordLayout layout_;
  std::uint64_t begin_byte_ = 0;
  std::uint64_t num_read_ = 0;
};

}  // namespace

Result<void> skip_ply_elements(InputFile& file, const PlyElement& element, bool swap_bytes) {
  if (!element.has_lists()) {
    const std::uint64_t size = element.fixed_bytes();
    const std::uint64_t left = file.size() - std::min(file.size(), file.offset());
    if (size == 0) return {};
    if (left / size < element.count) return cut_short(file, element, left / size);
    file.seek(file.offset() + size * element.count);
    return {};
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    auto whole = walk_element(file, element, swap_bytes, nullptr);
    if (!whole) return tl::unexpected(std::move(whole.error()));
    if (!*whole) return cut_short(file, element, i);
  }
  return {};
}

OpenedScan open_ply_list_vertices(InputFile file, ScanHeader header, const PlyElement& vertex, bool swap_bytes) {
  const RecordBlock at_least = {file.offset(), vertex.count};
  const auto least_bytes = static_cast<std::size_t>(without_lists(vertex).fixed_bytes());
  if (auto fits = check_record_count(file, least_bytes, at_least); !fits)
    return tl::unexpected(std::move(fits.error()));
  auto reader = std::make_unique<PlyListReader>(std::move(file), std::move(header), vertex, swap_bytes);
  if (auto chosen = reader->choose_from_sample(); !chosen) return tl::unexpected(std::move(chosen.error()));
  return reader;
}

}  // namespace isthmus::io
