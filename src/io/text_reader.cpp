#include "io/text_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

#include "io/line_reader.h"
#include "io/local_origin.h"
#include "io/notes.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

// Blocks up to this size are probed by reading all of them.
constexpr std::uint64_t kSmallBlockBytes = std::uint64_t{1} << 22;
constexpr std::size_t kPicksPerWindow = 8;

class TextReader final : public ProbingReader {
 public:
  TextReader(InputFile file, ScanHeader header, LineParser parser, const TextBlock& block)
      : file_(std::move(file)), header_(std::move(header)), parser_(std::move(parser)), block_(block) {
    rewind();
  }
  [[nodiscard]] const ScanHeader& header() const override { return header_; }
  Result<void> read(PointChunk& chunk, std::size_t max_points) override;
  Result<PointChunk> probe(std::size_t max_points) override;

  Result<void> choose_from_sample();

 private:
  void rewind();
  Result<bool> next_point(TextPoint& point);
  Result<void> check_end();
  [[nodiscard]] tl::unexpected<Error> bad_line(std::string_view line) const;
  Result<std::vector<TextPoint>> front(std::size_t max_points);
  Result<std::vector<TextPoint>> windows(std::size_t max_points, std::uint64_t end_byte) const;
  Result<std::uint64_t> end_of_points();
  void pick_from_window(std::string_view bytes, bool starts_a_line, std::size_t picks,
                        std::vector<TextPoint>& out) const;
  void append(const TextPoint& point, PointChunk& chunk) const;

  InputFile file_;
  ScanHeader header_;
  LineParser parser_;
  TextBlock block_;
  LineReader lines_{file_};
  std::uint64_t num_lines_ = 0;  // lines with points so far, no-returns too
  std::uint64_t num_no_returns_ = 0;
  bool ended_ = false;
};

void TextReader::rewind() {
  file_.seek(block_.begin_byte);
  lines_ = LineReader(file_, block_.begin_line);
  num_lines_ = num_no_returns_ = 0;
  ended_ = false;
}

tl::unexpected<Error> TextReader::bad_line(std::string_view line) const {
  const bool last = lines_.next_offset() >= file_.size();
  return fail((last ? "the last line is no whole point: " : "this line is no point: ") + in_quotes(line),
              at_line(file_.name(), lines_.number()),
              last ? "the file is cut short: export it again" : "remove the line or comment it out with #");
}

Result<bool> TextReader::next_point(TextPoint& point) {
  while (!(block_.num_lines && num_lines_ == *block_.num_lines) && lines_.next_offset() < block_.end_byte) {
    std::string_view line;
    auto got = lines_.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got) break;
    const LineKind kind = parser_(line, point);
    if (kind == LineKind::bad) return bad_line(line);
    if (kind == LineKind::skipped) continue;
    ++num_lines_;
    if (!block_.drop_no_returns || !point.p_in_scan.isZero(0.0)) return true;
    ++num_no_returns_;
  }
  return false;
}

Result<void> TextReader::check_end() {
  ended_ = true;
  if (block_.num_lines && num_lines_ < *block_.num_lines) {
    return fail(fmt::format("the header says {} points, the file holds {}", *block_.num_lines, num_lines_),
                at_line(file_.name(), lines_.number()), "the file is cut short: export it again");
  }
  if (num_no_returns_ > 0) header_.notes.push_back(fmt::format("{}{}", num_no_returns_, kNoReturnNote));
  if (block_.only_points && block_.num_lines && lines_.next_offset() < block_.end_byte) {
    header_.notes.push_back(
        fmt::format("the file goes on behind the {} points of its header (line {}): the rest is ignored",
                    *block_.num_lines, lines_.number() + 1));
  }
  return {};
}

void TextReader::append(const TextPoint& point, PointChunk& chunk) const {
  chunk.points.emplace_back((point.p_in_scan - header_.local_origin_in_scan).cast<float>());
  if (header_.has_intensity) chunk.intensity.push_back(point.intensity);
  if (header_.has_colour) chunk.colour.push_back(point.colour);
}

Result<void> TextReader::read(PointChunk& chunk, std::size_t max_points) {
  chunk.clear();
  if (ended_) return {};
  const std::size_t reserved = std::min(max_points, kReserveAtMost);
  chunk.points.reserve(reserved);
  TextPoint point;
  while (chunk.points.size() < max_points) {
    auto got = next_point(point);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got) return check_end();
    append(point, chunk);
  }
  return {};
}

// The first points of the block; the reading place moves.
Result<std::vector<TextPoint>> TextReader::front(std::size_t max_points) {
  rewind();
  std::vector<TextPoint> points;
  TextPoint point;
  while (points.size() < max_points) {
    auto got = next_point(point);
    if (!got && points.empty()) return tl::unexpected(std::move(got.error()));
    if (!got || !*got) break;  // a bad line further on is the reading's business
    points.push_back(point);
  }
  return points;
}

void TextReader::pick_from_window(std::string_view bytes, bool starts_a_line, std::size_t picks,
                                  std::vector<TextPoint>& out) const {
  std::vector<std::string_view> lines;
  std::size_t place = starts_a_line ? 0 : bytes.find('\n') + 1;  // npos + 1 = 0: no line end, and none follows
  for (std::size_t end; (end = bytes.find('\n', place)) != std::string_view::npos; place = end + 1) {
    lines.push_back(bytes.substr(place, end - place));
  }
  TextPoint point;
  const std::size_t n = std::min(picks, lines.size());
  for (std::size_t k = 0; k < n; ++k) {
    if (parser_(lines[k * lines.size() / n], point) != LineKind::point) continue;
    if (!block_.drop_no_returns || !point.p_in_scan.isZero(0.0)) out.push_back(point);
  }
}

Result<std::vector<TextPoint>> TextReader::windows(std::size_t max_points, std::uint64_t end_byte) const {
  const std::uint64_t length = end_byte - block_.begin_byte;
  const std::size_t count = std::min(kProbeWindows, (max_points + kPicksPerWindow - 1) / kPicksPerWindow);
  std::vector<TextPoint> points;
  std::string bytes;
  for (std::size_t w = 0; w < count; ++w) {
    const std::uint64_t begin = block_.begin_byte + length / count * w;
    bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kProbeWindowBytes, end_byte - begin)));
    auto read = file_.read_at(begin, bytes.data(), bytes.size());
    if (!read) return tl::unexpected(std::move(read.error()));
    pick_from_window(bytes, w == 0, max_points * (w + 1) / count - max_points * w / count, points);
  }
  return points;
}

// Where the lines with points end, by counting lines if other lines follow. Lines without points only make it too
// early.
Result<std::uint64_t> TextReader::end_of_points() {
  if (block_.only_points || !block_.num_lines) return block_.end_byte;
  file_.seek(block_.begin_byte);
  LineReader lines(file_, block_.begin_line);
  auto skipped = lines.skip(*block_.num_lines);
  if (!skipped) return tl::unexpected(std::move(skipped.error()));
  return lines.next_offset();
}

// Small blocks are read and thinned, large ones are looked at in windows. Reading goes on where it was.
Result<PointChunk> TextReader::probe(std::size_t max_points) {
  const std::uint64_t place = file_.offset();
  const auto state = std::tuple(lines_, num_lines_, num_no_returns_, ended_);
  const bool small = block_.end_byte - block_.begin_byte <= kSmallBlockBytes;
  Result<std::uint64_t> end = small ? Result<std::uint64_t>(block_.end_byte) : end_of_points();
  auto points = !end    ? Result<std::vector<TextPoint>>(tl::unexpected(end.error()))
                : small ? front(block_.end_byte)
                        : windows(max_points, *end);
  file_.seek(place);
  std::tie(lines_, num_lines_, num_no_returns_, ended_) = state;
  if (!points) return tl::unexpected(std::move(points.error()));
  PointChunk chunk;
  const std::size_t n = std::min(max_points, points->size());
  for (std::size_t k = 0; k < n; ++k) append((*points)[k * points->size() / n], chunk);
  return chunk;
}

Result<void> TextReader::choose_from_sample() {
  const bool large = block_.only_points && block_.end_byte - block_.begin_byte > kSmallBlockBytes;
  Result<std::vector<TextPoint>> sample = large ? windows(kOpeningSample, block_.end_byte) : front(kOpeningSample);
  if (sample && sample->empty()) sample = front(1);
  if (!sample) return tl::unexpected(std::move(sample.error()));
  if (sample->empty()) return fail("the file holds no points", file_.name());
  std::vector<Eigen::Vector3d> positions;
  for (const TextPoint& point : *sample) positions.push_back(point.p_in_scan);
  header_.local_origin_in_scan = local_origin_of(positions);
  if (block_.origin_is_station && header_.local_origin_in_scan.isZero(0.0)) {
    header_.station_in_scan = Eigen::Vector3d::Zero();
  } else if (block_.origin_is_station) {
    header_.notes.push_back("the points lie over 10 km from the origin, which cannot be the station: no station taken");
  }
  rewind();
  return {};
}

}  // namespace

OpenedScan open_text(InputFile file, ScanHeader header, LineParser parser, const TextBlock& block) {
  constexpr std::uint64_t kShortestLineBytes = 2;
  const std::uint64_t most_lines = (block.end_byte - block.begin_byte) / kShortestLineBytes + 1;
  if (block.num_lines && *block.num_lines > most_lines) {
    return fail(fmt::format("the header says {} points, the file holds less than {}", *block.num_lines, most_lines),
                at_byte(file.name(), file.size()), "the file is cut short or its header is wrong: export it again");
  }
  auto reader = std::make_unique<TextReader>(std::move(file), std::move(header), std::move(parser), block);
  if (auto chosen = reader->choose_from_sample(); !chosen) return tl::unexpected(std::move(chosen.error()));
  return reader;
}

}  // namespace isthmus::io
