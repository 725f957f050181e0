#include "io/e57/e57_scan.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>

#include "io/e57/e57_xml.h"
#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr int kDeepestPrototype = 16;        // real ones have one level
constexpr std::size_t kMostFields = 0xFFFF;  // a packet counts its bytestreams in 16 bits

template <class T>
Result<T> attribute_of(const pugi::xml_node& node, const char* name, T absent, const std::string& where) {
  const auto attribute = node.attribute(name);
  if (!attribute) return absent;
  const auto value = whole_number<T>(trimmed(attribute.value()));
  if (value) return *value;
  return fail(fmt::format("the {} of '{}' is no number: {}", name, node.name(), in_quotes(attribute.value())), where);
}

Result<E57Field> integer_field(const pugi::xml_node& node, bool scaled, const std::string& where) {
  using Limits = std::numeric_limits<std::int64_t>;
  const auto minimum = attribute_of<std::int64_t>(node, "minimum", Limits::min(), where);
  const auto maximum = attribute_of<std::int64_t>(node, "maximum", Limits::max(), where);
  const auto scale = attribute_of<double>(node, "scale", 1.0, where);
  const auto offset = attribute_of<double>(node, "offset", 0.0, where);
  for (const auto* limit : {&minimum, &maximum}) {
    if (!*limit) return tl::unexpected(limit->error());
  }
  for (const auto* number : {&scale, &offset}) {
    if (scaled && !*number) return tl::unexpected(number->error());
  }
  if (*minimum > *maximum) {
    return fail(fmt::format("the minimum {} of '{}' is above its maximum {}", *minimum, node.name(), *maximum), where);
  }
  const std::uint64_t range = static_cast<std::uint64_t>(*maximum) - static_cast<std::uint64_t>(*minimum);
  const auto bits = static_cast<unsigned>(std::bit_width(range));
  return E57Field{node.name(),           E57FieldKind::integer, *minimum, *maximum, bits,
                  scaled ? *scale : 1.0, scaled ? *offset : 0.0};
}

// Appends the number fields at and below the children of a node, in the order of the XML.
Result<void> append_fields(const pugi::xml_node& parent, int depth, std::vector<E57Field>& fields,
                           const std::string& where) {
  if (depth > kDeepestPrototype) return fail("the prototype of the points is nested too deeply", where);
  for (const pugi::xml_node& node : parent.children()) {
    if (node.type() != pugi::node_element) continue;
    const std::string_view type = node.attribute("type").value();
    if (type == "Structure" || type == "Vector") {
      if (auto inside = append_fields(node, depth + 1, fields, where); !inside) return inside;
      continue;
    }
    E57Field field = {node.name()};
    if (type == "Integer" || type == "ScaledInteger") {
      auto integer = integer_field(node, type == "ScaledInteger", where);
      if (!integer) return tl::unexpected(std::move(integer.error()));
      field = std::move(*integer);
    } else if (type == "Float") {
      const bool single = std::string_view(node.attribute("precision").value()) == "single";
      field.kind = single ? E57FieldKind::float32 : E57FieldKind::float64;
      field.bits = single ? 32 : 64;
    } else if (type != "String") {
      return fail(fmt::format("the field '{}' is of unknown type {}", node.name(), in_quotes(type)), where);
    }
    if (fields.size() == kMostFields) return fail("the prototype of the points has too many fields", where);
    fields.push_back(std::move(field));
  }
  return {};
}

Result<void> check_codecs(const pugi::xml_node& codecs, const std::string& where) {
  for (const pugi::xml_node& entry : codecs.children()) {
    for (const pugi::xml_node& codec : entry.children()) {
      const std::string_view name = codec.name();
      if (codec.type() != pugi::node_element || name == "inputs" || name == "bitPackCodec") continue;
      return fail("unsupported format: points packed by the codec " + in_quotes(name), where,
                  "bit packing is read: export the file again without another codec");
    }
  }
  return {};
}

E57Limits limits_of(const pugi::xml_node& limits, const std::string& quantity) {
  const auto low = e57_number(limits.child((quantity + "Minimum").c_str()));
  const auto high = e57_number(limits.child((quantity + "Maximum").c_str()));
  if (!low || !high || !(*low < *high)) return std::nullopt;
  return std::pair(*low, *high);
}

std::string joined(const pugi::xml_node& node, std::initializer_list<const char*> names) {
  std::string all;
  for (const char* name : names) {
    const std::string text = e57_text(node.child(name));
    if (!text.empty()) all.append(all.empty() ? "" : " ").append(text);
  }
  return all;
}

std::size_t num_elements(const pugi::xml_node& vector) {
  std::size_t count = 0;
  for (const pugi::xml_node& child : vector.children()) count += child.type() == pugi::node_element ? 1 : 0;
  return count;
}

pugi::xml_node element(const pugi::xml_node& vector, int index) {
  for (const pugi::xml_node& child : vector.children()) {
    if (child.type() == pugi::node_element && index-- == 0) return child;
  }
  return {};
}

}  // namespace

std::string at_e57_scan(std::string_view file, int index) {
  return fmt::format("{}, scan #{} in its XML", file, index);
}

Result<std::size_t> num_e57_scans(const std::string& xml, const std::string& file) {
  pugi::xml_document document;
  if (auto parsed = parse_e57_xml(xml, file, false, document); !parsed)
    return tl::unexpected(std::move(parsed.error()));
  return num_elements(document.child("e57Root").child("data3D"));
}

Result<E57Scan> e57_scan(const std::string& xml, int index, const std::string& file) {
  pugi::xml_document document;
  if (auto parsed = parse_e57_xml(xml, file, false, document); !parsed)
    return tl::unexpected(std::move(parsed.error()));
  const pugi::xml_node data3d = document.child("e57Root").child("data3D");
  const pugi::xml_node node = index < 0 ? pugi::xml_node() : element(data3d, index);
  if (!node) {
    return fail(fmt::format("the file holds {} scans, there is no #{}", num_elements(data3d), index), file,
                "scans are counted from 0");
  }
  const std::string where = at_e57_scan(file, index);
  E57Scan scan;
  scan.guid = e57_text(node.child("guid"));
  scan.name = e57_text(node.child("name"));
  scan.sensor = joined(node, {"sensorVendor", "sensorModel"});
  scan.file_from_scan = e57_pose(node.child("pose"));
  if (node.child("pose") && !scan.file_from_scan) {
    scan.notes.emplace_back("the stored pose is no unit quaternion and translation: no pose taken");
  }
  const pugi::xml_node points = node.child("points");
  if (!points) return fail("the scan has no points", where);
  const auto section = attribute_of<std::uint64_t>(points, "fileOffset", 0, where);
  if (!section) return tl::unexpected(section.error());
  const auto records = attribute_of<std::uint64_t>(points, "recordCount", 0, where);
  if (!records) return tl::unexpected(records.error());
  scan.section_physical = *section;
  scan.num_records = *records;
  if (auto fields = append_fields(points.child("prototype"), 0, scan.fields, where); !fields) {
    return tl::unexpected(std::move(fields.error()));
  }
  if (auto packed = check_codecs(points.child("codecs"), where); !packed) {
    return tl::unexpected(std::move(packed.error()));
  }
  scan.intensity_limits = limits_of(node.child("intensityLimits"), "intensity");
  const std::array<const char*, 3> colours = {"colorRed", "colorGreen", "colorBlue"};
  for (std::size_t c = 0; c < 3; ++c) scan.colour_limits[c] = limits_of(node.child("colorLimits"), colours[c]);
  return scan;
}

}  // namespace isthmus::io
