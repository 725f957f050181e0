#include "io/e57/e57_writer.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/e57/e57_packets.h"
#include "io/e57/e57_page_writer.h"
#include "io/e57/e57_xml_writer.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kMostFields = 7;
// Whole records, so that no packet ends within one; the rest of the 64 KiB is the packet's header.
constexpr std::size_t kPieceBytes = kE57MostPacketBytes - 64;

template <class T>
void append_bytes(std::string& out, T value) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  out.append(raw, sizeof(T));
}

std::size_t bytes_per_record(const E57ScanInfo& info) {
  return (info.double_coordinates ? 3 * sizeof(double) : 3 * sizeof(float)) + (info.has_intensity ? sizeof(float) : 0) +
         (info.has_colour ? 3 : 0);
}

void append_prototype(pugi::xml_node points, const E57ScanInfo& info) {
  pugi::xml_node prototype = append_e57_node(points, "prototype", "Structure");
  for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"}) {
    append_e57_node(prototype, name, "Float").append_attribute("precision") =
        info.double_coordinates ? "double" : "single";
  }
  if (info.has_intensity) append_e57_node(prototype, "intensity", "Float").append_attribute("precision") = "single";
  for (const char* name : {"colorRed", "colorGreen", "colorBlue"}) {
    if (!info.has_colour) break;
    pugi::xml_node colour = append_e57_node(prototype, name, "Integer");
    colour.append_attribute("minimum") = 0;
    colour.append_attribute("maximum") = 255;
  }
  append_e57_node(points, "codecs", "Vector").append_attribute("allowHeterogeneousChildren") = 1;
}

}  // namespace

struct E57Writer::State {
  E57PageWriter pages;
  std::string path;
  pugi::xml_document document;
  pugi::xml_node data3d;
  Digest all_guids;
  // the scan begun last
  bool in_scan = false;
  E57ScanInfo info;
  std::uint64_t section = 0;  // logical offset of its header
  std::uint64_t num_records = 0;
  std::array<std::string, kMostFields> pieces;  // of the packet that is being filled
  std::size_t in_packet = 0;
  Digest points_digest;
  Eigen::AlignedBox3d bounds;
  std::pair<float, float> intensity_range;

  State(E57PageWriter writer, std::string name) : pages(std::move(writer)), path(std::move(name)) {}

  void add_record(const PointChunk& points, std::size_t i, const Eigen::Vector3d& origin);
  Result<void> end_packet();
  Result<void> end_scan();
  void describe_scan();
};

void E57Writer::State::add_record(const PointChunk& points, std::size_t i, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d p = points.points[i].cast<double>() + origin;
  if (p.allFinite()) bounds.extend(p);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double value = p[static_cast<Eigen::Index>(axis)];
    if (info.double_coordinates) {
      append_bytes(pieces[axis], value);
    } else {
      append_bytes(pieces[axis], static_cast<float>(value));
    }
  }
  std::size_t field = 3;
  if (info.has_intensity) {
    const float value = points.intensity[i];
    append_bytes(pieces[field++], value);
    if (std::isfinite(value)) {
      intensity_range = {std::min(intensity_range.first, value), std::max(intensity_range.second, value)};
    }
  }
  for (std::size_t c = 0; info.has_colour && c < 3; ++c) append_bytes(pieces[field++], points.colour[i][c]);
  ++in_packet;
  ++num_records;
}

Result<void> E57Writer::State::end_packet() {
  if (in_packet == 0) return {};
  const std::size_t num_fields = 3 + (info.has_intensity ? 1 : 0) + (info.has_colour ? 3 : 0);
  std::string lengths, bytes;
  for (std::size_t f = 0; f < num_fields; ++f) {
    append_bytes(lengths, static_cast<std::uint16_t>(pieces[f].size()));
    bytes += pieces[f];
    pieces[f].clear();
  }
  std::string packet;
  append_bytes(packet, kE57DataPacket);
  append_bytes(packet, std::uint8_t{0});
  const std::size_t length = (3 * sizeof(std::uint16_t) + lengths.size() + bytes.size() + 3) / 4 * 4;
  append_bytes(packet, static_cast<std::uint16_t>(length - 1));
  append_bytes(packet, static_cast<std::uint16_t>(num_fields));
  packet += lengths + bytes;
  packet.resize(length, '\0');
  points_digest.add(packet);
  in_packet = 0;
  return pages.append(packet);
}

Result<void> E57Writer::State::end_scan() {
  if (!std::exchange(in_scan, false)) return {};
  if (auto ended = end_packet(); !ended) return ended;
  std::string header(8, '\0');
  header[0] = static_cast<char>(kE57SectionId);
  append_bytes(header, pages.logical() - section);
  append_bytes(header, e57_physical(section + kE57SectionHeaderBytes));
  append_bytes(header, std::uint64_t{0});  // no index packets: they are optional
  describe_scan();
  return pages.fill_in(section, header);
}

void E57Writer::State::describe_scan() {
  pugi::xml_node scan = append_e57_node(data3d, "vectorChild", "Structure");
  if (info.guid.empty()) {
    Digest digest;
    digest.add(info.name).add(points_digest.hex());
    info.guid = e57_guid(digest);
  }
  all_guids.add(info.guid);
  append_e57_string(scan, "guid", info.guid);
  if (!info.name.empty()) append_e57_string(scan, "name", info.name);
  if (!bounds.isEmpty()) {
    pugi::xml_node node = append_e57_node(scan, "cartesianBounds", "Structure");
    constexpr std::array<const char*, 6> kNames = {"xMinimum", "xMaximum", "yMinimum",
                                                   "yMaximum", "zMinimum", "zMaximum"};
    for (int axis = 0; axis < 3; ++axis) {
      append_e57_float(node, kNames[static_cast<std::size_t>(2 * axis)], bounds.min()[axis]);
      append_e57_float(node, kNames[static_cast<std::size_t>(2 * axis + 1)], bounds.max()[axis]);
    }
  }
  if (info.has_intensity && intensity_range.first <= intensity_range.second) {
    pugi::xml_node node = append_e57_node(scan, "intensityLimits", "Structure");
    append_e57_float(node, "intensityMinimum", static_cast<double>(intensity_range.first));
    append_e57_float(node, "intensityMaximum", static_cast<double>(intensity_range.second));
  }
  if (info.has_colour) {
    pugi::xml_node node = append_e57_node(scan, "colorLimits", "Structure");
    for (const char* colour : {"colorRed", "colorGreen", "colorBlue"}) {
      append_e57_integer(node, (std::string(colour) + "Minimum").c_str(), 0);
      append_e57_integer(node, (std::string(colour) + "Maximum").c_str(), 255);
    }
  }
  pugi::xml_node points = append_e57_node(scan, "points", "CompressedVector");
  points.append_attribute("fileOffset") = fmt::format("{}", e57_physical(section)).c_str();
  points.append_attribute("recordCount") = fmt::format("{}", num_records).c_str();
  append_prototype(points, info);
  if (info.file_from_scan) set_e57_pose(scan, *info.file_from_scan);
}

E57Writer::E57Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
E57Writer::E57Writer(E57Writer&&) noexcept = default;
E57Writer& E57Writer::operator=(E57Writer&&) noexcept = default;
E57Writer::~E57Writer() = default;

Result<E57Writer> E57Writer::create(const std::filesystem::path& path, const std::string& coordinates) {
  auto pages = E57PageWriter::create(path);
  if (!pages) return tl::unexpected(std::move(pages.error()));
  auto state = std::make_unique<State>(std::move(*pages), path.string());
  pugi::xml_node declaration = state->document.append_child(pugi::node_declaration);
  declaration.append_attribute("version") = "1.0";
  declaration.append_attribute("encoding") = "UTF-8";
  pugi::xml_node root = append_e57_node(state->document, "e57Root", "Structure");
  root.append_attribute("xmlns") = "http://www.astm.org/COMMIT/E57/2010-e57-v1.0";
  append_e57_string(root, "formatName", "ASTM E57 3D Imaging Data File");
  append_e57_string(root, "guid", "");
  append_e57_integer(root, "versionMajor", 1);
  append_e57_integer(root, "versionMinor", 0);
  append_e57_string(root, "e57LibraryVersion", "isthmus");
  if (!coordinates.empty()) append_e57_string(root, "coordinateMetadata", coordinates);
  state->data3d = append_e57_node(root, "data3D", "Vector");
  state->data3d.append_attribute("allowHeterogeneousChildren") = 1;
  pugi::xml_node images = append_e57_node(root, "images2D", "Vector");
  images.append_attribute("allowHeterogeneousChildren") = 1;
  return E57Writer(std::move(state));
}

Result<void> E57Writer::begin_scan(E57ScanInfo info) {
  if (auto ended = state_->end_scan(); !ended) return ended;
  if (auto aligned = state_->pages.align(); !aligned) return aligned;
  auto section = state_->pages.reserve(kE57SectionHeaderBytes);
  if (!section) return tl::unexpected(std::move(section.error()));
  state_->section = *section;
  state_->info = std::move(info);
  state_->in_scan = true;
  state_->num_records = 0;
  state_->points_digest = Digest();
  state_->bounds.setEmpty();
  state_->intensity_range = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
  return {};
}

Result<void> E57Writer::add(const PointChunk& points, const Eigen::Vector3d& local_origin_in_scan) {
  const std::size_t n = points.points.size();
  const E57ScanInfo& info = state_->info;
  if (!state_->in_scan || (info.has_intensity && points.intensity.size() != n) ||
      (info.has_colour && points.colour.size() != n)) {
    return fail(fmt::format("{} points, {} intensities and {} colours are not what was announced", n,
                            points.intensity.size(), points.colour.size()),
                state_->path);
  }
  const std::size_t records_per_packet = kPieceBytes / bytes_per_record(info);
  for (std::size_t i = 0; i < n; ++i) {
    state_->add_record(points, i, local_origin_in_scan);
    if (state_->in_packet < records_per_packet) continue;
    if (auto ended = state_->end_packet(); !ended) return ended;
  }
  return {};
}

Result<void> E57Writer::publish() {
  if (auto ended = state_->end_scan(); !ended) return ended;
  state_->document.child("e57Root").child("guid").text().set(e57_guid(state_->all_guids).c_str());
  return state_->pages.publish(e57_xml_text(state_->document, false));
}

}  // namespace isthmus::io
