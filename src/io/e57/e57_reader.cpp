#include "io/e57/e57_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "io/e57/e57_columns.h"
#include "io/e57/e57_file.h"
#include "io/e57/e57_marks.h"
#include "io/local_origin.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kRecordsPerBlock = 4096;  // their numbers fit into the processor's cache
constexpr std::size_t kWindows = 256;           // times a packet of up to 64 KiB: a probe reads at most 32 MiB or so
constexpr std::size_t kRecordsPerWindow = 1024;

class E57Reader final : public ProbingReader {
 public:
  E57Reader(E57Packets packets, E57Columns columns, ScanHeader header)
      : packets_(std::move(packets)), start_(columns), columns_(std::move(columns)), header_(std::move(header)) {}
  [[nodiscard]] const ScanHeader& header() const override { return header_; }
  Result<void> read(PointChunk& chunk, std::size_t max_points) override;
  Result<PointChunk> probe(std::size_t max_points) override;

  Result<void> choose_from_front();

 private:
  [[nodiscard]] std::uint64_t num_records() const { return *header_.num_points; }
  void note_end();

  E57Packets packets_;
  E57Columns start_;  // at record 0, to begin anew from
  E57Columns columns_;
  ScanHeader header_;
  std::uint64_t num_read_ = 0, num_left_out_ = 0;
  bool ended_ = false;
  std::optional<E57Marks> marks_;
};

void E57Reader::note_end() {
  if (std::exchange(ended_, true) || num_left_out_ == 0) return;
  header_.notes.push_back(fmt::format("{} points without valid coordinates (invalid state) left out", num_left_out_));
}

Result<void> E57Reader::read(PointChunk& chunk, std::size_t max_points) {
  chunk.clear();
  while (chunk.points.size() < max_points && num_read_ < num_records()) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(
        std::min(kRecordsPerBlock, max_points - chunk.points.size()), num_records() - num_read_));
    if (auto done = columns_.read(packets_, n); !done) return done;
    num_read_ += n;
    for (std::size_t i = 0; i < n; ++i) {
      if (columns_.is_valid(i)) {
        columns_.append(i, header_.local_origin_in_scan, chunk);
      } else {
        ++num_left_out_;
      }
    }
  }
  if (num_read_ == num_records()) note_end();
  return {};
}

// The valid ones of the first records, until there are enough to see what the numbers are.
Result<void> E57Reader::choose_from_front() {
  E57Columns columns = start_;
  std::vector<Eigen::Vector3d> positions;
  double largest_colour = 0.0;
  for (std::uint64_t done = 0; done < num_records() && positions.size() < kOpeningSample;) {
    const auto n = static_cast<std::size_t>(std::min<std::uint64_t>(kOpeningSample, num_records() - done));
    auto read = columns.read(packets_, n);
    if (!read && positions.empty()) return read;
    if (!read) break;  // reading will say so
    done += n;
    largest_colour = std::max(largest_colour, columns.largest_colour());
    for (std::size_t i = 0; i < n; ++i) {
      if (columns.is_valid(i)) positions.push_back(columns.position(i));
    }
  }
  if (positions.empty()) {
    return fail(fmt::format("the scan holds no valid points: all {} are marked invalid", num_records()),
                packets_.name());
  }
  start_.choose_colour_scale(largest_colour);
  columns_ = start_;
  header_.local_origin_in_scan = local_origin_of(positions);
  if (header_.local_origin_in_scan.isZero(0.0)) {
    header_.station_in_scan = Eigen::Vector3d::Zero();
  } else {
    header_.notes.emplace_back(
        "the points lie over 10 km from the origin, which cannot be the station: no station taken");
  }
  return {};
}

// Records spread evenly: windows at even distances, and evenly spread valid records inside each.
Result<PointChunk> E57Reader::probe(std::size_t max_points) {
  if (!marks_) {
    auto marks = E57Marks::walk(packets_, start_, num_records());
    if (!marks) return tl::unexpected(std::move(marks.error()));
    marks_ = std::move(*marks);
  }
  E57Columns columns = start_;
  PointChunk chunk;
  const auto picks = static_cast<std::size_t>(std::min<std::uint64_t>(max_points, num_records()));
  const std::size_t windows = std::min(picks, kWindows);
  for (std::size_t w = 0; w < windows; ++w) {
    const auto at = [&](std::size_t k) {
      return static_cast<std::uint64_t>(static_cast<unsigned __int128>(num_records()) * k / windows);
    };
    const std::size_t share = picks * (w + 1) / windows - picks * w / windows;
    const auto length =
        static_cast<std::size_t>(std::min<std::uint64_t>(at(w + 1) - at(w), std::max(share, kRecordsPerWindow)));
    if (auto there = marks_->seek(columns, packets_, at(w)); !there) return tl::unexpected(std::move(there.error()));
    if (auto read = columns.read(packets_, length); !read) return tl::unexpected(std::move(read.error()));
    std::vector<std::size_t> valid;
    for (std::size_t i = 0; i < length; ++i) {
      if (columns.is_valid(i)) valid.push_back(i);
    }
    const std::size_t taken = std::min(share, valid.size());
    for (std::size_t k = 0; k < taken; ++k) {
      columns.append(valid[k * valid.size() / taken], header_.local_origin_in_scan, chunk);
    }
  }
  return chunk;
}

// A record takes space, or the file would be a few bytes that say "a billion points".
Result<void> check_count(const E57Scan& scan, const E57Section& section, const E57Pages& pages, E57Columns& columns,
                         const std::string& where) {
  std::uint64_t most = pages.logical_size() * 8;
  columns.each_stream([&](const E57Stream& stream) {
    const unsigned bits = scan.fields[stream.stream()].bits;
    if (bits > 0) most = std::min(most, (section.end - section.begin) * 8 / bits);
  });
  if (scan.num_records <= most) return {};
  return fail(fmt::format("the XML says {} points, the file holds at most {}", scan.num_records, most), where,
              "the file is damaged: export it again");
}

ScanHeader header_of(const E57Scan& scan, const E57Columns& columns) {
  ScanHeader header;
  header.format = "e57";
  header.num_points = scan.num_records;
  header.file_from_scan = scan.file_from_scan;
  header.has_intensity = columns.has_intensity();
  header.has_colour = columns.has_colour();
  std::string note = columns.is_spherical() ? "spherical coordinates" : "Cartesian coordinates";
  if (!scan.name.empty()) note += ", name " + in_quotes(scan.name);
  if (!scan.sensor.empty()) note += ", sensor " + in_quotes(scan.sensor);
  if (columns.has_intensity() && scan.intensity_limits) {
    note += fmt::format(", intensity limits {} to {}", scan.intensity_limits->first, scan.intensity_limits->second);
  }
  header.notes.push_back(std::move(note));
  header.notes.insert(header.notes.end(), scan.notes.begin(), scan.notes.end());
  return header;
}

}  // namespace

Result<std::vector<ScanRef>> scans_of_e57(const std::filesystem::path& path) {
  const auto file = open_e57_file(path);
  if (!file) return tl::unexpected(file.error());
  const auto count = num_e57_scans(file->xml, path.string());
  if (!count) return tl::unexpected(count.error());
  if (*count == 0) return fail("the file holds no scans", path.string());
  if (*count > static_cast<std::size_t>(std::numeric_limits<int>::max())) return fail("too many scans", path.string());
  std::vector<ScanRef> scans;
  for (std::size_t k = 0; k < *count; ++k) scans.push_back({path, static_cast<int>(k), {}});
  return scans;
}

OpenedScan open_e57(const ScanRef& scan) {
  auto file = open_e57_file(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  const auto e57 = e57_scan(file->xml, scan.index, file->pages.name());
  if (!e57) return tl::unexpected(e57.error());
  const std::string where = at_e57_scan(file->pages.name(), scan.index);
  // Writers leave the section out (offset 0) or empty if there are no points.
  auto section = e57->num_records == 0 && e57->section_physical == 0
                     ? Result<E57Section>(E57Section())
                     : read_e57_section(file->pages, e57->section_physical, where);
  if (!section) return tl::unexpected(std::move(section.error()));
  if (e57->num_records == 0) return fail("the scan holds no points", where);
  auto columns = E57Columns::of(*e57, *section, where);
  if (!columns) return tl::unexpected(std::move(columns.error()));
  if (auto fits = check_count(*e57, *section, file->pages, *columns, where); !fits) {
    return tl::unexpected(std::move(fits.error()));
  }
  ScanHeader header = header_of(*e57, *columns);
  auto reader = std::make_unique<E57Reader>(E57Packets(std::move(file->pages), *section, e57->fields.size()),
                                            std::move(*columns), std::move(header));
  if (auto chosen = reader->choose_from_front(); !chosen) return tl::unexpected(std::move(chosen.error()));
  return reader;
}

}  // namespace isthmus::io
