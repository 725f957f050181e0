#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "io/las/laszip_handle.h"
#include "io/las/laz.h"
#include "io/las/laz_chunks.h"
#include "io/local_origin.h"
#include "io/record_layout.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

/// What is kept of a decompressed point, for the code that all records go through.
struct Kept {
  std::int32_t x, y, z;
  std::uint16_t intensity, red, green, blue;
};
static_assert(sizeof(Kept) == 20);

RecordLayout layout_of(const LasHeader& las) {
  const auto axis = [&](std::size_t a) {
    return RecordField{ScalarType::int32, 4 * a, sizeof(Kept), las.scale[a], las.offset[a]};
  };
  const auto number = [](std::size_t offset) { return RecordField{ScalarType::uint16, offset, sizeof(Kept)}; };
  RecordLayout layout;
  layout.bytes_per_record = sizeof(Kept);
  layout.x = axis(0);
  layout.y = axis(1);
  layout.z = axis(2);
  layout.intensity = number(offsetof(Kept, intensity));
  if (las.point_format().colour != 0)
    layout.colour = {number(offsetof(Kept, red)), number(offsetof(Kept, green)), number(offsetof(Kept, blue))};
  return layout;
}

/// Decompresses points one after the other, from any place on.
class PointSource {
 public:
  static Result<PointSource> open(const std::string& path, std::uint64_t num_points) {
    PointSource source(path, num_points);
    laszip_BOOL compressed = 0;
    const laszip_POINTER laszip = source.laszip_.get();
    // Layers of new point formats that nobody asks for are not decompressed.
    constexpr laszip_U32 kWanted = laszip_DECOMPRESS_SELECTIVE_CHANNEL_RETURNS_XY | laszip_DECOMPRESS_SELECTIVE_Z |
                                   laszip_DECOMPRESS_SELECTIVE_INTENSITY | laszip_DECOMPRESS_SELECTIVE_RGB;
    if (laszip_decompress_selective(laszip, kWanted) != 0 ||
        laszip_open_reader(laszip, path.c_str(), &compressed) != 0 ||
        laszip_get_point_pointer(laszip, &source.point_) != 0) {
      return fail("LASzip cannot read it: " + source.laszip_.error(), path);
    }
    return source;
  }

  Result<void> seek(std::uint64_t index) {
    if (index == next_) return {};
    if (laszip_seek_point(laszip_.get(), static_cast<laszip_I64>(index)) != 0) return damage(index);
    next_ = index;
    return {};
  }

  Result<void> read(std::size_t count, std::vector<Kept>& out) {
    for (std::size_t k = 0; k < count; ++k, ++next_) {
      if (laszip_read_point(laszip_.get()) != 0) return damage(next_);
      out.push_back(
          {point_->X, point_->Y, point_->Z, point_->intensity, point_->rgb[0], point_->rgb[1], point_->rgb[2]});
    }
    return {};
  }

 private:
  PointSource(std::string path, std::uint64_t num_points) : path_(std::move(path)), num_points_(num_points) {}
  [[nodiscard]] tl::unexpected<Error> damage(std::uint64_t index) const {
    return fail(fmt::format("the compressed points are damaged or missing from point {} of {} on", index, num_points_),
                path_, "export the file again");
  }

  LaszipHandle laszip_;
  laszip_point_struct* point_ = nullptr;
  std::string path_;
  std::uint64_t num_points_ = 0;
  std::uint64_t next_ = 0;
};

/// Which points lie outside the bounds that the header states: all there is to tell damage by, for LAZ has no
/// checksums.
class OutsideBounds {
 public:
  explicit OutsideBounds(const LasHeader& las) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      // In steps, a step wider for what rounding did.
      const double a = (las.low[axis] - las.offset[axis]) / las.scale[axis];
      const double b = (las.high[axis] - las.offset[axis]) / las.scale[axis];
      low_[axis] = std::min(a, b) - 1;
      high_[axis] = std::max(a, b) + 1;
      stated_ = stated_ || las.low[axis] != 0 || las.high[axis] != 0;
    }
  }
  void count(const std::vector<Kept>& records) {
    for (const Kept& p : records) {
      const std::array<double, 3> raw = {static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
      bool inside = true;
      for (std::size_t axis = 0; axis < 3; ++axis)
        inside = inside && raw[axis] >= low_[axis] && raw[axis] <= high_[axis];
      outside_ += inside ? 0 : 1;
    }
  }
  [[nodiscard]] std::optional<std::string> note() const {
    if (!stated_ || outside_ == 0) return std::nullopt;
    return fmt::format("{} points lie outside the bounds in the header: the file is damaged or the header wrong",
                       outside_);
  }

 private:
  std::array<double, 3> low_{}, high_{};
  bool stated_ = false;
  std::uint64_t outside_ = 0;
};

class LazReader final : public ProbingReader {
 public:
  LazReader(std::string path, const LasHeader& las, const LazChunks& chunks, PointSource points)
      : path_(std::move(path)),
        header_(scan_header_of(las)),
        layout_(layout_of(las)),
        num_points_(las.num_points),
        chunks_(chunks),
        outside_(las),
        points_(std::move(points)) {
    header_.num_points = num_points_;
    header_.has_intensity = true;
    header_.has_colour = layout_.colour.has_value();
  }
  [[nodiscard]] const ScanHeader& header() const override { return header_; }

  Result<void> read(PointChunk& chunk, std::size_t max_points) override {
    chunk.clear();
    const auto wanted = static_cast<std::size_t>(std::min<std::uint64_t>(max_points, num_points_ - num_read_));
    for (std::size_t done = 0; done < wanted;) {
      const std::size_t n = std::min(wanted - done, kReserveAtMost);
      records_.clear();
      if (auto read = points_.read(n, records_); !read) return read;
      append(records_, chunk);
      outside_.count(records_);
      done += n;
      num_read_ += n;
      if (num_read_ < num_points_) continue;
      if (const auto note = outside_.note()) header_.notes.push_back(*note);
    }
    return {};
  }

  Result<PointChunk> probe(std::size_t max_points) override {
    auto sample = sampled(max_points);
    if (!sample) return tl::unexpected(std::move(sample.error()));
    PointChunk chunk;
    append(*sample, chunk);
    return chunk;
  }

  Result<void> choose_from_sample() {
    const auto sample = sampled(kOpeningSample);
    if (!sample) return tl::unexpected(sample.error());
    const char* const bytes = reinterpret_cast<const char*>(sample->data());
    choose_colour_scale(layout_, bytes, sample->size());
    header_.local_origin_in_scan = local_origin_of(positions_of_records(layout_, bytes, 0, sample->size()));
    return {};
  }

 private:
  void append(const std::vector<Kept>& records, PointChunk& chunk) const {
    append_records(layout_, reinterpret_cast<const char*>(records.data()), 0, records.size(),
                   header_.local_origin_in_scan, chunk);
  }
  Result<std::vector<Kept>> sampled(std::size_t max_points) const;

  std::string path_;
  ScanHeader header_;
  RecordLayout layout_;
  std::uint64_t num_points_;
  LazChunks chunks_;
  OutsideBounds outside_;
  PointSource points_;
  std::vector<Kept> records_;
  std::uint64_t num_read_ = 0;
};

// Reading can begin at a chunk's first point only: points evenly spread over the beginnings of chunks that are evenly
// spread over the file. A chunk has 50,000 points as a rule, a hundredth of a second's work.
Result<std::vector<Kept>> LazReader::sampled(std::size_t max_points) const {
  constexpr std::uint64_t kWindows = 64, kMostDecompressed = std::uint64_t{1} << 17;
  constexpr std::uint64_t kWindowsInside = 16;  // where chunks begin is LASzip's secret if their size varies
  auto points = PointSource::open(path_, num_points_);
  if (!points) return tl::unexpected(std::move(points.error()));
  const std::uint64_t per_chunk = chunks_.points_per_chunk > 0
                                      ? std::min(chunks_.points_per_chunk, num_points_)
                                      : std::max<std::uint64_t>(1, num_points_ / kWindowsInside);
  const std::uint64_t num_chunks = (num_points_ + per_chunk - 1) / per_chunk;
  const std::uint64_t picks = std::min<std::uint64_t>(max_points, num_points_);
  const std::uint64_t windows = std::min({picks, num_chunks, kWindows});
  std::vector<Kept> sample, window;
  for (std::uint64_t w = 0; w < windows; ++w) {
    const std::uint64_t begin = num_chunks * w / windows * per_chunk;
    const std::uint64_t share = picks * (w + 1) / windows - picks * w / windows;
    const std::uint64_t length =
        std::min({per_chunk, num_points_ - begin, std::max(kMostDecompressed / windows, share)});
    window.clear();
    if (auto found = points->seek(begin); !found) return tl::unexpected(std::move(found.error()));
    if (auto read = points->read(static_cast<std::size_t>(length), window); !read)
      return tl::unexpected(std::move(read.error()));
    const std::uint64_t taken = std::min(share, length);
    for (std::uint64_t k = 0; k < taken; ++k) sample.push_back(window[static_cast<std::size_t>(k * length / taken)]);
  }
  return sample;
}

}  // namespace

bool has_laz() { return true; }

OpenedScan open_laz(InputFile file, const LasHeader& las) {
  if (las.num_points == 0) return fail("the file holds no points", file.name());
  const auto chunks = read_laz_chunks(file, las);
  if (!chunks) return tl::unexpected(chunks.error());
  auto points = PointSource::open(file.name(), las.num_points);
  if (!points) return tl::unexpected(std::move(points.error()));
  auto reader = std::make_unique<LazReader>(file.name(), las, *chunks, std::move(*points));
  if (auto chosen = reader->choose_from_sample(); !chosen) return tl::unexpected(std::move(chosen.error()));
  return reader;
}

}  // namespace isthmus::io
