#include "evaluate/inputs.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include <fmt/format.h>

#include "base/atomic_file.h"
#include "io/scan_name.h"

namespace isthmus::evaluate {
namespace {

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Calls take(words) for every line; take returns false for a line that it cannot understand.
template <class Take>
Result<void> for_each_line(const std::filesystem::path& path, const char* expected, const Take& take) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  std::istringstream lines(*text);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    const std::vector<std::string> words = words_of(line);
    if (!words.empty() && !take(words))
      return fail(fmt::format("cannot understand '{}'", line.substr(0, 80)),
                  fmt::format("{}, line {}", path.string(), count), fmt::format("expected {}", expected));
  }
  return {};
}

std::optional<std::vector<double>> numbers(const std::vector<std::string>& words, std::size_t first,
                                           std::size_t count) {
  std::vector<double> values;
  for (std::size_t k = first; k < first + count; ++k) {
    const std::optional<double> value = k < words.size() ? number(words[k]) : std::nullopt;
    if (!value) return std::nullopt;
    values.push_back(*value);
  }
  return values;
}

}  // namespace

std::string file_name_of(const std::string& scan_name) {
  const std::string decoded = io::percent_decoded(scan_name);
  return decoded.substr(decoded.rfind('/') == std::string::npos ? 0 : decoded.rfind('/') + 1);
}

Result<Poses> read_poses(const std::filesystem::path& path) {
  Poses poses;
  const Result<void> read = for_each_line(path, "a name and 12 numbers", [&](const std::vector<std::string>& words) {
    if (words[0].front() == '#' || words.size() < 13) return true;
    const auto values = numbers(words, 1, 12);
    if (!values) return false;
    Transform t = Transform::Identity();
    for (int k = 0; k < 12; ++k) t(k / 4, k % 4) = (*values)[k];
    poses.emplace_back(words[0], t);
    return true;
  });
  if (!read) return tl::unexpected(read.error());
  return poses;
}

Result<Overlaps> read_overlaps(const std::filesystem::path& path) {
  Overlaps overlaps;
  const Result<void> read =
      for_each_line(path, "'# voxel V' or two names and an overlap", [&](const std::vector<std::string>& words) {
        if (words[0].front() == '#') {
          if (words.size() >= 3 && words[1] == "voxel") overlaps.voxel_m = number(words[2]);
          return true;
        }
        if (words.size() != 3) return true;
        const std::optional<double> value = number(words[2]);
        if (value) overlaps.of[pair_key(words[0], words[1])] = *value;
        return value.has_value();
      });
  if (!read) return tl::unexpected(read.error());
  return overlaps;
}

Result<std::vector<Edge>> read_g2o_edges(const std::filesystem::path& path) {
  std::vector<Edge> edges;
  const Result<void> read =
      for_each_line(path, "EDGE_SE3:QUAT i j x y z qx qy qz qw ...", [&](const std::vector<std::string>& words) {
        if (words[0] != "EDGE_SE3:QUAT") return true;
        const auto values = numbers(words, 1, 9);
        if (!values) return false;
        const std::vector<double>& v = *values;
        Edge edge{static_cast<int>(v[0]), static_cast<int>(v[1]), Transform::Identity()};
        edge.from_to.translation() = Eigen::Vector3d(v[2], v[3], v[4]);
        edge.from_to.linear() = Eigen::Quaterniond(v[8], v[5], v[6], v[7]).normalized().toRotationMatrix();
        edges.push_back(edge);
        return true;
      });
  if (!read) return tl::unexpected(read.error());
  return edges;
}

std::vector<std::vector<std::string>> parse_csv(const std::string& text) {
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> row(1);
  bool quoted = false;
  const auto end_row = [&] {
    if (row.size() > 1 || !row[0].empty()) rows.push_back(std::move(row));
    row.assign(1, {});
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted && c == '"' && i + 1 < text.size() && text[i + 1] == '"')
      row.back() += text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (quoted)
      row.back() += c;
    else if (c == ',')
      row.emplace_back();
    else if (c == '\n')
      end_row();
    else if (c != '\r')
      row.back() += c;
  }
  end_row();
  return rows;
}

Result<std::vector<ScanRow>> read_scans_csv(const std::filesystem::path& path) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  const auto rows = parse_csv(*text);
  const auto column = [&](const char* name) -> std::size_t {
    if (rows.empty()) return 0;
    return static_cast<std::size_t>(std::find(rows[0].begin(), rows[0].end(), name) - rows[0].begin());
  };
  const std::size_t id = column("id"), name = column("name"), component = column("component"),
                    voxel = column("voxel_m");
  if (rows.empty() || id == rows[0].size() || name == rows[0].size())
    return fail("the columns id and name are missing", path.string(), "is this the scans.csv of a finished run?");
  std::vector<ScanRow> out;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string>& row = rows[k];
    const std::optional<double> value = id < row.size() ? number(row[id]) : std::nullopt;
    if (!value || name >= row.size())
      return fail("cannot understand the row", fmt::format("{}, row {}", path.string(), k + 1));
    out.push_back({static_cast<int>(*value), file_name_of(row[name]), component < row.size() ? row[component] : "0",
                   voxel < row.size() ? number(row[voxel]) : std::nullopt});
  }
  return out;
}

}  // namespace isthmus::evaluate
