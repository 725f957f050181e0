#include "report/finished_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <tuple>

#include "base/atomic_file.h"
#include "io/text_number.h"

namespace isthmus::report {
namespace {

using Words = std::vector<std::string_view>;

std::optional<std::vector<double>> numbers_of(const Words& words, std::size_t first, std::size_t count) {
  if (words.size() != first + count) return std::nullopt;
  std::vector<double> numbers;
  for (std::size_t k = first; k < words.size(); ++k) {
    const auto number = io::whole_number<double>(words[k]);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// x y z qx qy qz qw
Transform pose_of(const double* v) {
  Transform t = Transform::Identity();
  t.linear() = Eigen::Quaterniond(v[6], v[3], v[4], v[5]).normalized().toRotationMatrix();
  t.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  return t;
}

/// Calls take(words) for every line with words; false means that the line cannot be understood.
template <class Take>
Result<void> each_line(const std::filesystem::path& path, const Take& take) {
  const Result<std::string> text = read_file(path);
  if (!text) return tl::unexpected(text.error());
  std::size_t number = 0;
  for (std::size_t begin = 0; begin < text->size();) {
    const std::size_t end = std::min(text->find('\n', begin), text->size());
    const Words words = io::words_of(std::string_view(*text).substr(begin, end - begin));
    begin = end + 1;
    ++number;
    if (words.empty() || take(words)) continue;
    return fail("this line is none that 'register' writes", fmt::format("{}, line {}", path.string(), number));
  }
  return {};
}

// The inverse of g2o_information() on 21 numbers.
Matrix6d information_of(const double* upper) {
  Matrix6d m;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) m(row, column) = m(column, row) = *upper++;
  }
  m.topRightCorner<3, 3>() /= 2.0;
  m.bottomLeftCorner<3, 3>() /= 2.0;
  m.bottomRightCorner<3, 3>() /= 4.0;
  return m;
}

Result<std::vector<int>> read_graph(const std::filesystem::path& path, FinishedSurvey& survey) {
  std::vector<int> ids;
  const auto read = each_line(path, [&](const Words& words) {
    const bool vertex = words[0] == "VERTEX_SE3:QUAT", edge = words[0] == "EDGE_SE3:QUAT";
    const auto first = words.size() > 1 ? io::whole_number<int>(words[1]) : std::nullopt;
    if ((!vertex && !edge) || !first) return false;
    if (vertex) {
      ids.push_back(*first);
      return true;
    }
    constexpr std::size_t kPose = 7, kInformation = 21;
    const auto source = words.size() > 2 ? io::whole_number<int>(words[2]) : std::nullopt;
    const auto numbers = numbers_of(words, 3, kPose + kInformation);
    if (!source || !numbers) return false;
    survey.links.push_back({*first, *source, pose_of(numbers->data()), information_of(numbers->data() + kPose)});
    return true;
  });
  if (!read) return tl::unexpected(read.error());
  return ids;
}

/// Numbers the parts that the links join, the largest first, of equal ones the one with the smallest id.
void number_components(FinishedSurvey& survey) {
  std::map<int, int> part;  // id -> an id that stands for its part
  for (const FinishedScan& scan : survey.scans) part[scan.id] = scan.id;
  for (const FinishedLink& link : survey.links) {
    const int from = part[link.source], to = part[link.target];
    for (auto& [id, stands_for] : part) {
      if (stands_for == from) stands_for = to;
    }
  }
  std::map<int, std::pair<int, int>> size_and_first;  // per part: -size, smallest id
  for (const auto& [id, stands_for] : part) {
    const auto [entry, is_new] = size_and_first.try_emplace(stands_for, 0, id);
    --entry->second.first;
  }
  std::map<std::pair<int, int>, int> number_of;
  for (const auto& [stands_for, key] : size_and_first) number_of[key] = 0;
  int next = 0;
  for (auto& [key, number] : number_of) number = next++;
  for (FinishedScan& scan : survey.scans) scan.component = number_of[size_and_first[part[scan.id]]];
}

}  // namespace

int FinishedSurvey::num_components() const {
  int most = -1;
  for (const FinishedScan& scan : scans) most = std::max(most, scan.component);
  return most + 1;
}

Result<FinishedSurvey> read_finished_survey(const std::filesystem::path& out) {
  std::error_code error;
  if (!std::filesystem::exists(out / "pose_graph.g2o", error))
    return fail(std::filesystem::is_directory(out, error) ? "no survey was finished in this folder" : "no such folder",
                out.string(), "name the output folder of 'isthmus register'");
  FinishedSurvey survey;
  const auto ids = read_graph(out / "pose_graph.g2o", survey);
  if (!ids) return tl::unexpected(ids.error());
  const std::filesystem::path poses = out / "poses.txt";
  const auto read = each_line(poses, [&](const Words& words) {
    const auto numbers = numbers_of(words, 1, 12);
    if (!numbers) return false;
    FinishedScan scan;
    scan.name = words[0];
    for (int k = 0; k < 12; ++k) scan.component_from_scan(k / 4, k % 4) = (*numbers)[static_cast<std::size_t>(k)];
    survey.scans.push_back(std::move(scan));
    return true;
  });
  if (!read) return tl::unexpected(read.error());
  // Both files list the placed scans in the same order.
  if (survey.scans.size() != ids->size()) {
    return fail(fmt::format("{} poses, but pose_graph.g2o has {} vertices", survey.scans.size(), ids->size()),
                poses.string(), "are both of the same run?");
  }
  for (std::size_t k = 0; k < ids->size(); ++k) survey.scans[k].id = (*ids)[k];
  for (const FinishedLink& link : survey.links) {
    for (const int id : {link.source, link.target}) {
      if (std::find(ids->begin(), ids->end(), id) != ids->end()) continue;
      return fail(fmt::format("an edge names the vertex {}, which is missing", id), (out / "pose_graph.g2o").string());
    }
  }
  number_components(survey);
  return survey;
}

}  // namespace isthmus::report
