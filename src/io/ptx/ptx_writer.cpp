#include "io/ptx/ptx_writer.h"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <string>
#include <utility>

namespace isthmus::io {
namespace {

// The number of points is known at the end only: leading zeros keep its place, and every reader of numbers skips them.
std::string count_text(std::uint64_t count) { return fmt::format("{:012}\n", count); }

void append_row(std::string& out, double a, double b, double c) {
  fmt::format_to(std::back_inserter(out), "{} {} {}", a + 0.0, b + 0.0, c + 0.0);
}

}  // namespace

Result<PtxWriter> PtxWriter::create(const std::filesystem::path& path) {
  auto file = OutputFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  return PtxWriter(std::move(*file));
}

Result<void> PtxWriter::write(const std::string& text) {
  size_ += text.size();
  return file_.write(text);
}

Result<void> PtxWriter::finish_scan() {
  if (!in_scan_) return {};
  in_scan_ = false;
  return file_.overwrite(count_place_, count_text(count_));
}

Result<void> PtxWriter::begin_scan(const Transform& pose, bool colour) {
  if (auto finished = finish_scan(); !finished) return finished;
  in_scan_ = true;
  colour_ = colour;
  count_ = 0;
  count_place_ = size_;
  std::string header = count_text(0) + "1\n";
  const Eigen::Vector3d& t = pose.translation();
  append_row(header, t.x(), t.y(), t.z());
  for (int axis = 0; axis < 3; ++axis) {
    header += '\n';
    append_row(header, pose(0, axis), pose(1, axis), pose(2, axis));
  }
  for (int row = 0; row < 3; ++row) {
    header += '\n';
    append_row(header, pose(0, row), pose(1, row), pose(2, row));
    header += " 0";
  }
  header += '\n';
  append_row(header, t.x(), t.y(), t.z());
  return write(header + " 1\n");
}

Result<void> PtxWriter::add(const PointChunk& chunk, const Eigen::Vector3d& origin) {
  constexpr float kMiddle = 0.5f;
  const bool intensity = !chunk.intensity.empty();
  std::string text;
  for (std::size_t i = 0; i < chunk.points.size(); ++i) {
    if (!chunk.points[i].allFinite()) continue;
    const Eigen::Vector3d p = chunk.points[i].cast<double>() + origin;
    auto end = std::back_inserter(text);
    fmt::format_to(end, "{:.6f} {:.6f} {:.6f} {:.6g}", p.x(), p.y(), p.z(), intensity ? chunk.intensity[i] : kMiddle);
    if (colour_) {
      const bool known = i < chunk.colour.size();
      for (std::size_t k = 0; k < 3; ++k) fmt::format_to(end, " {}", known ? chunk.colour[i][k] : 0);
    }
    text += '\n';
    ++count_;
  }
  return write(text);
}

Result<void> PtxWriter::publish() {
  if (auto finished = finish_scan(); !finished) return finished;
  return file_.publish();
}

}  // namespace isthmus::io
