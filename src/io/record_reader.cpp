#include "io/record_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "io/local_origin.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

class RecordReader final : public ProbingReader {
 public:
  RecordReader(InputFile file, ScanHeader header, const RecordLayout& layout, const RecordBlock& block)
      : file_(std::move(file)), header_(std::move(header)), layout_(layout), block_(block) {
    file_.seek(block_.begin_byte);
  }
  [[nodiscard]] const ScanHeader& header() const override { return header_; }
  Result<void> read(PointChunk& chunk, std::size_t max_points) override;
  Result<PointChunk> probe(std::size_t max_points) override;

  Result<void> choose_from_sample();

 private:
  Result<std::vector<char>> sample_bytes(std::size_t max_records) const;

  InputFile file_;
  ScanHeader header_;
  RecordLayout layout_;
  RecordBlock block_;
  std::uint64_t num_read_ = 0;
};

Result<void> RecordReader::read(PointChunk& chunk, std::size_t max_points) {
  chunk.clear();
  const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(max_points, block_.num_records - num_read_));
  while (chunk.points.size() < wanted) {
    auto bytes = file_.peek(layout_.bytes_per_record);
    if (!bytes) return tl::unexpected(std::move(bytes.error()));
    const std::size_t n = std::min(bytes->size() / layout_.bytes_per_record, wanted - chunk.points.size());
    if (n == 0) {
      return fail(fmt::format("the file became shorter while it was read, after {} points", num_read_),
                  at_byte(file_.name(), file_.offset()));
    }
    append_records(layout_, bytes->data(), 0, n, header_.local_origin_in_scan, chunk);
    file_.consume(n * layout_.bytes_per_record);
    num_read_ += n;
  }
  return {};
}

// Records spread evenly: windows at even distances, and evenly spread records inside each window.
Result<std::vector<char>> RecordReader::sample_bytes(std::size_t max_records) const {
  const std::uint64_t total = block_.num_records;
  const std::size_t size = layout_.bytes_per_record;
  const auto picks = static_cast<std::size_t>(std::min<std::uint64_t>(max_records, total));
  const std::size_t windows = std::min(picks, kProbeWindows);
  std::vector<char> sample, window;
  for (std::size_t w = 0; w < windows; ++w) {
    const auto begin = static_cast<std::uint64_t>(static_cast<unsigned __int128>(total) * w / windows);
    const auto end = static_cast<std::uint64_t>(static_cast<unsigned __int128>(total) * (w + 1) / windows);
    const std::size_t length = static_cast<std::size_t>(
        std::min<std::uint64_t>(end - begin, std::max<std::size_t>(1, kProbeWindowBytes / size)));
    const std::size_t share = std::min(length, picks * (w + 1) / windows - picks * w / windows);
    window.resize(length * size);
    auto read = file_.read_at(block_.begin_byte + begin * size, window.data(), window.size());
    if (!read) return tl::unexpected(std::move(read.error()));
    for (std::size_t k = 0; k < share; ++k) {
      const char* record = window.data() + k * length / share * size;
      sample.insert(sample.end(), record, record + size);
    }
  }
  return sample;
}

Result<PointChunk> RecordReader::probe(std::size_t max_points) {
  auto sample = sample_bytes(max_points);
  if (!sample) return tl::unexpected(std::move(sample.error()));
  PointChunk chunk;
  append_records(layout_, sample->data(), 0, sample->size() / layout_.bytes_per_record, header_.local_origin_in_scan,
                 chunk);
  return chunk;
}

Result<void> RecordReader::choose_from_sample() {
  auto sample = sample_bytes(kOpeningSample);
  if (!sample) return tl::unexpected(std::move(sample.error()));
  const std::size_t n = sample->size() / layout_.bytes_per_record;
  choose_colour_scale(layout_, sample->data(), n);
  header_.local_origin_in_scan = local_origin_of(positions_of_records(layout_, sample->data(), 0, n));
  header_.has_intensity = layout_.intensity.has_value();
  header_.has_colour = layout_.colour.has_value() || layout_.packed_rgb.has_value();
  return {};
}

}  // namespace

Result<void> check_record_count(const InputFile& file, std::size_t bytes_per_record, const RecordBlock& block) {
  if (block.num_records == 0) return fail("the file holds no points", file.name());
  const std::uint64_t left = file.size() - std::min(file.size(), block.begin_byte);
  if (left / bytes_per_record < block.num_records) {
    return fail(fmt::format("the header says {} points, the file holds {}", block.num_records, left / bytes_per_record),
                at_byte(file.name(), file.size()), "the file is cut short or its header is wrong: export it again");
  }
  return {};
}

OpenedScan open_records(InputFile file, ScanHeader header, const RecordLayout& layout, const RecordBlock& block) {
  if (auto fits = check_record_count(file, layout.bytes_per_record, block); !fits) {
    return tl::unexpected(std::move(fits.error()));
  }
  header.num_points = block.num_records;
  auto reader = std::make_unique<RecordReader>(std::move(file), std::move(header), layout, block);
  if (auto chosen = reader->choose_from_sample(); !chosen) return tl::unexpected(std::move(chosen.error()));
  return reader;
}

}  // namespace isthmus::io
