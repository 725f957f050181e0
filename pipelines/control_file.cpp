#include "pipelines/control_file.h"

#include <fmt/format.h>
#include <fnmatch.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/atomic_file.h"
#include "config/yaml.h"
#include "io/text_number.h"
#include "pipelines/csv_fields.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

constexpr double kRotationTolerance = 1e-4;  // matrices are printed with six digits or more
constexpr double kRadPerDeg = std::numbers::pi / 180.0;

/// One mapping of the YAML file.
struct Entry {
  YAML::Node node;
  std::string file;

  [[nodiscard]] std::string where() const { return config::place(file, node.Mark()); }

  Result<std::string> word(const char* key) const {
    if (!node[key] || !node[key].IsScalar()) return fail(fmt::format("'{}' is missing", key), where());
    return node[key].Scalar();
  }
  Result<std::vector<double>> numbers(const char* key) const {
    if (!node[key]) return fail(fmt::format("'{}' is missing", key), where());
    Result<config::Written> written = config::written_in(node[key], file);
    if (!written) return tl::unexpected(written.error());
    std::vector<double> out;
    for (const std::string& text : written->words) {
      const auto number = io::whole_number<double>(text);
      if (!number || !std::isfinite(*number)) {
        return fail(fmt::format("'{}' in '{}' is not a finite number", text, key),
                    config::place(file, node[key].Mark()));
      }
      out.push_back(*number);
    }
    return out;
  }
  Result<Eigen::Vector3d> vector(const char* key) const {
    const auto v = numbers(key);
    if (!v) return tl::unexpected(v.error());
    if (v->size() == 3) return Eigen::Vector3d((*v)[0], (*v)[1], (*v)[2]);
    return fail(fmt::format("'{}' holds {} numbers, 3 are wanted", key, v->size()), where());
  }
  /// One or three standard deviations, all above zero.
  Result<Eigen::Vector3d> sigma(const char* key) const {
    const auto v = numbers(key);
    if (!v) return tl::unexpected(v.error());
    if (v->size() != 1 && v->size() != 3) {
      return fail(fmt::format("'{}' holds {} numbers, 1 or 3 are wanted", key, v->size()), where());
    }
    const Eigen::Vector3d s((*v)[0], v->size() == 3 ? (*v)[1] : (*v)[0], v->back());
    if (s.minCoeff() > 0) return s;
    return fail(fmt::format("a standard deviation of {} in '{}'", s.minCoeff(), key), where(),
                "give what the measurement is good for; for something fixed, a millimetre");
  }
  Result<void> check(std::vector<std::string> keys) const { return config::check_keys(node, keys, file); }
};

template <class T>
bool take(const Result<T>& result, T& into, Error& error) {
  if (result) {
    into = *result;
  } else {
    error = result.error();
  }
  return result.has_value();
}

Result<Transform> rigid(const std::vector<double>& v, const std::string& where) {
  if (v.size() != 12 && v.size() != 16) {
    return fail(fmt::format("'matrix' holds {} numbers, 12 or 16 are wanted", v.size()), where, "row by row");
  }
  Transform t = Transform::Identity();
  for (std::size_t k = 0; k < 12; ++k) t.matrix()(static_cast<int>(k / 4), static_cast<int>(k % 4)) = v[k];
  const Eigen::Matrix3d rotation = t.linear();
  const double skewness = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (rotation.determinant() > 0 && skewness <= kRotationTolerance) return orthonormalised(t);
  return fail(fmt::format("'matrix' is not a rigid transform: {:.2g} off orthonormal, determinant {:.6g}", skewness,
                          rotation.determinant()),
              where);
}

Result<ControlItem> item_of(ControlKind kind, bool station, const Entry& entry) {
  ControlItem item;
  item.kind = kind;
  item.where = entry.where();
  if (!entry.node.IsMap()) return fail("a mapping is wanted, such as {scan: a.ply, ...}", item.where);
  using Keys = std::vector<std::string>;
  const Keys keys = kind == ControlKind::levelled ? Keys{"scan", "sigma_deg"}
                    : kind == ControlKind::pose   ? Keys{"scan", "name", "matrix", "sigma_m", "sigma_deg"}
                    : station                     ? Keys{"scan", "name", "world", "sigma_m"}
                                                  : Keys{"scan", "name", "local", "world", "sigma_m"};
  if (const auto known = entry.check(keys); !known) return tl::unexpected(known.error());
  Error error;
  if (!take(entry.word("scan"), item.scan, error)) return tl::unexpected(error);
  item.name = entry.node["name"] && entry.node["name"].IsScalar() ? entry.node["name"].Scalar() : item.scan;
  if (kind != ControlKind::levelled && !take(entry.sigma("sigma_m"), item.sigma_m, error)) return tl::unexpected(error);
  if (kind != ControlKind::point) {
    Eigen::Vector3d deg = Eigen::Vector3d::Zero();
    if (!take(entry.sigma("sigma_deg"), deg, error)) return tl::unexpected(error);
    item.sigma_rad = deg[0] * kRadPerDeg;
  }
  if (kind == ControlKind::point && !take(entry.vector("world"), item.p_in_world, error)) return tl::unexpected(error);
  if (kind == ControlKind::point && !station) {
    Eigen::Vector3d local = Eigen::Vector3d::Zero();
    if (!take(entry.vector("local"), local, error)) return tl::unexpected(error);
    item.p_in_scan = local;
  }
  if (kind != ControlKind::pose) return item;
  const auto numbers = entry.numbers("matrix");
  if (!numbers) return tl::unexpected(numbers.error());
  if (!take(rigid(*numbers, item.where), item.world_from_scan, error)) return tl::unexpected(error);
  return item;
}

Result<std::vector<ControlItem>> from_yaml(const std::string& text, const std::string& file) {
  const Result<YAML::Node> node = config::parse_yaml(text, file);
  if (!node) return tl::unexpected(node.error());
  struct Section {
    const char* key;
    ControlKind kind;
    bool station;
  };
  constexpr std::array<Section, 4> kSections = {{{"points", ControlKind::point, false},
                                                 {"stations", ControlKind::point, true},
                                                 {"poses", ControlKind::pose, false},
                                                 {"levelled", ControlKind::levelled, false}}};
  std::vector<std::string> keys;
  for (const Section& section : kSections) keys.emplace_back(section.key);
  if (!node->IsMap()) return fail("a mapping of points, stations, poses and levelled is wanted", file);
  if (const auto known = config::check_keys(*node, keys, file); !known) return tl::unexpected(known.error());
  std::vector<ControlItem> items;
  for (const Section& section : kSections) {
    const YAML::Node list = (*node)[section.key];
    if (!list || list.IsNull()) continue;
    if (!list.IsSequence()) return fail(fmt::format("'{}' is a list", section.key), config::place(file, list.Mark()));
    for (const auto& one : list) {
      Result<ControlItem> item = item_of(section.kind, section.station, {one, file});
      if (!item) return tl::unexpected(item.error());
      items.push_back(std::move(*item));
    }
  }
  return items;
}

constexpr std::array<const char*, 9> kColumns = {"name",    "scan",    "local_x", "local_y", "local_z",
                                                 "world_x", "world_y", "world_z", "sigma_m"};

Result<ControlItem> item_of_row(const std::vector<std::string>& fields, const std::array<std::size_t, 9>& column,
                                const std::string& where) {
  ControlItem item;
  item.where = where;
  item.name = fields[column[0]];
  item.scan = fields[column[1]];
  if (item.name.empty()) item.name = item.scan;
  std::array<double, 7> v{};
  const bool station = fields[column[2]].empty() && fields[column[3]].empty() && fields[column[4]].empty();
  for (std::size_t k = station ? 3 : 0; k < v.size(); ++k) {
    const std::string& text = fields[column[2 + k]];
    const auto number = io::whole_number<double>(text);
    if (!number || !std::isfinite(*number)) {
      return fail(fmt::format("'{}' under {} is not a finite number", text, kColumns[2 + k]), where);
    }
    v[k] = *number;
  }
  if (v[6] <= 0) return fail(fmt::format("a standard deviation of {}", v[6]), where, "give what the point is good for");
  if (!station) item.p_in_scan = Eigen::Vector3d(v[0], v[1], v[2]);
  item.p_in_world = Eigen::Vector3d(v[3], v[4], v[5]);
  item.sigma_m.setConstant(v[6]);
  return item;
}

Result<std::vector<ControlItem>> from_csv(const std::string& text, const std::string& file) {
  std::vector<ControlItem> items;
  std::vector<std::string> header;
  std::array<std::size_t, 9> column{};
  for (const auto& [number, fields] : csv_lines(text)) {
    const std::string where = fmt::format("{}:{}", file, number);
    if (header.empty()) {
      header = fields;
      for (std::size_t k = 0; k < kColumns.size(); ++k) {
        column[k] = static_cast<std::size_t>(std::find(header.begin(), header.end(), kColumns[k]) - header.begin());
        if (column[k] == header.size()) {
          return fail(fmt::format("there is no column '{}'", kColumns[k]), where,
                      "the first line names name, scan, local_x, local_y, local_z, world_x, world_y, world_z, sigma_m");
        }
      }
      continue;
    }
    if (fields.size() != header.size()) {
      return fail(fmt::format("{} fields, the first line has {}", fields.size(), header.size()), where);
    }
    Result<ControlItem> item = item_of_row(fields, column, where);
    if (!item) return tl::unexpected(item.error());
    items.push_back(std::move(*item));
  }
  return items;
}

Result<Eigen::Vector3d> station_of(const report::ScanRecord& scan, const std::string& where) {
  if (scan.station_kind == StationKind::origin) return scan.station;
  return fail(fmt::format("where the scanner stood in {} is not known for sure ({})", scan.name,
                          report::word(scan.station_kind)),
              where, "give it as a point with its local coordinates");
}

}  // namespace

Result<std::vector<ControlItem>> read_control(const fs::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return tl::unexpected(text.error());
  const bool csv = file.extension() == ".csv" || file.extension() == ".CSV";
  Result<std::vector<ControlItem>> items = csv ? from_csv(*text, file.string()) : from_yaml(*text, file.string());
  if (items && items->empty()) return fail("there is no control in it", file.string());
  return items;
}

Result<Control> control_of(const std::vector<ControlItem>& items, const MeasuredSurvey& survey) {
  Control control;
  for (const ControlItem& item : items) {
    if (item.kind == ControlKind::levelled) {
      bool any = false;
      for (const report::ScanRecord& scan : survey.scans) {
        if (::fnmatch(item.scan.c_str(), scan.name.c_str(), 0) != 0) continue;
        any = true;
        control.levelled.push_back({scan.id, item.sigma_rad});
      }
      if (any) continue;
    }
    const Result<int> id = scan_id_of(survey, item.scan);
    if (!id) return fail(id.error().what, item.where, id.error().hint);
    const report::ScanRecord& scan = survey.scans[static_cast<std::size_t>(*id)];
    const Eigen::Translation3d local_from_scan(-scan.local_origin_in_scan);
    if (item.kind == ControlKind::levelled) {
      control.levelled.push_back({*id, item.sigma_rad});
    } else if (item.kind == ControlKind::pose) {
      control.poses.push_back(
          {item.name, *id, item.world_from_scan * local_from_scan.inverse(), item.sigma_m[0], item.sigma_rad});
    } else if (item.p_in_scan) {
      control.points.push_back({item.name, *id, local_from_scan * *item.p_in_scan, item.p_in_world, item.sigma_m});
    } else {
      const Result<Eigen::Vector3d> station = station_of(scan, item.where);
      if (!station) return tl::unexpected(station.error());
      control.points.push_back({item.name, *id, *station, item.p_in_world, item.sigma_m});
    }
  }
  return control;
}

}  // namespace isthmus::pipelines
