#include "io/pcd/pcd_compressed.h"

#include <fmt/format.h>
#include <pcl/io/lzf.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <utility>

#include "io/local_origin.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

// Three bytes of LZF stand for at most 264.
constexpr std::uint64_t kLargestExpansion = 88;

class ColumnsReader final : public ProbingReader {
 public:
  ColumnsReader(std::vector<char> bytes, ScanHeader header, const RecordLayout& layout)
      : bytes_(std::move(bytes)), header_(std::move(header)), layout_(layout) {
    const auto n = static_cast<std::size_t>(*header_.num_points);
    choose_colour_scale(layout_, bytes_.data(), n);
    std::vector<Eigen::Vector3d> sample;
    for (std::size_t k = 0; k < kOpeningSample; ++k) {
      sample.push_back(positions_of_records(layout_, bytes_.data(), n * k / kOpeningSample, 1)[0]);
    }
    header_.local_origin_in_scan = local_origin_of(sample);
    header_.has_intensity = layout_.intensity.has_value();
    header_.has_colour = layout_.colour.has_value() || layout_.packed_rgb.has_value();
  }
  [[nodiscard]] const ScanHeader& header() const override { return header_; }

  Result<void> read(PointChunk& chunk, std::size_t max_points) override {
    chunk.clear();
    const std::size_t n = std::min(max_points, static_cast<std::size_t>(*header_.num_points) - num_read_);
    append_records(layout_, bytes_.data(), num_read_, n, header_.local_origin_in_scan, chunk);
    num_read_ += n;
    return {};
  }

  Result<PointChunk> probe(std::size_t max_points) override {
    const auto total = static_cast<std::size_t>(*header_.num_points);
    const std::size_t n = std::min(max_points, total);
    PointChunk chunk;
    for (std::size_t k = 0; k < n; ++k) {
      const auto i = static_cast<std::size_t>(static_cast<unsigned __int128>(total) * k / n);
      append_records(layout_, bytes_.data(), i, 1, header_.local_origin_in_scan, chunk);
    }
    return chunk;
  }

 private:
  std::vector<char> bytes_;
  ScanHeader header_;
  RecordLayout layout_;
  std::size_t num_read_ = 0;
};

std::uint32_t little_endian_32(const char* bytes) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

}  // namespace

Result<std::vector<char>> decompress_pcd_block(InputFile& file, const PcdHeader& pcd) {
  std::array<char, 8> sizes = {};
  const std::uint64_t begin = pcd.data_begin;
  if (auto read = file.read_at(begin, sizes.data(), sizes.size()); !read)
    return tl::unexpected(std::move(read.error()));
  const std::uint64_t packed = little_endian_32(sizes.data());
  const std::uint64_t unpacked = little_endian_32(sizes.data() + 4);
  const std::uint64_t left = file.size() - begin - sizes.size();
  if (packed > left) {
    return fail(fmt::format("the compressed block should be {} bytes, the file holds {}", packed, left),
                at_byte(file.name(), file.size()), "the file is cut short: export it again");
  }
  const std::uint64_t size = pcd.bytes_per_point();
  if (unpacked / size != pcd.num_points || unpacked % size != 0) {
    return fail(fmt::format("the header says {} points of {} bytes, the compressed block holds {} bytes",
                            pcd.num_points, size, unpacked),
                at_byte(file.name(), begin));
  }
  const std::string where = at_byte(file.name(), begin + sizes.size());
  if (unpacked > packed * kLargestExpansion) return fail("the compressed block is too short for its points", where);
  std::vector<char> in(static_cast<std::size_t>(packed)), out(static_cast<std::size_t>(unpacked));
  if (auto read = file.read_at(begin + sizes.size(), in.data(), in.size()); !read) {
    return tl::unexpected(std::move(read.error()));
  }
  const unsigned done =
      pcl::lzfDecompress(in.data(), static_cast<unsigned>(packed), out.data(), static_cast<unsigned>(unpacked));
  if (done != unpacked) return fail("the compressed block is damaged", where, "export the file again");
  return out;
}

OpenedScan open_pcd_columns(std::vector<char> bytes, ScanHeader header, const RecordLayout& layout) {
  return std::make_unique<ColumnsReader>(std::move(bytes), std::move(header), layout);
}

}  // namespace isthmus::io
