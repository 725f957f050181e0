#include "io/e57/e57_xml.h"

#include <fmt/format.h>

#include <cmath>

#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

std::string_view text_of(const pugi::xml_node& node) {
  std::string_view text = node.child_value();
  const std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

}  // namespace

Result<void> parse_e57_xml(const std::string& xml, const std::string& file, bool keep_all,
                           pugi::xml_document& document) {
  const unsigned everything = pugi::parse_full | pugi::parse_ws_pcdata;
  const auto parsed =
      document.load_buffer(xml.data(), xml.size(), keep_all ? everything : pugi::parse_default, pugi::encoding_utf8);
  if (!parsed) {
    std::string_view near = xml;
    near.remove_prefix(std::min(xml.size(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, parsed.offset))));
    return fail(fmt::format("the XML section cannot be read: {} at {}", parsed.description(), in_quotes(near)),
                fmt::format("{}, byte {} of its XML", file, parsed.offset));
  }
  if (!document.child("e57Root")) return fail("the XML section has no element 'e57Root'", file);
  return {};
}

std::string e57_text(const pugi::xml_node& node) {
  std::string text;
  for (const pugi::xml_node& piece : node.children()) {
    if (piece.type() == pugi::node_pcdata || piece.type() == pugi::node_cdata) text += piece.value();
  }
  return text;
}

std::optional<double> e57_number(const pugi::xml_node& node) {
  if (!node) return std::nullopt;
  const std::string_view text = text_of(node);
  const auto raw = text.empty() ? std::optional(0.0) : whole_number<double>(text);
  if (!raw || std::string_view(node.attribute("type").value()) != "ScaledInteger") return raw;
  const auto attribute = [&](const char* name, double absent) {
    return whole_number<double>(node.attribute(name).value()).value_or(absent);
  };
  return *raw * attribute("scale", 1.0) + attribute("offset", 0.0);
}

std::optional<Transform> e57_pose(const pugi::xml_node& pose) {
  if (!pose) return std::nullopt;
  constexpr double kUnitTolerance = 1e-3;  // six printed digits and some
  Transform transform = Transform::Identity();
  const auto number = [](const pugi::xml_node& parent, const char* name) {
    return e57_number(parent.child(name)).value_or(std::nan(""));
  };
  if (const auto rotation = pose.child("rotation")) {
    const Eigen::Quaterniond q(number(rotation, "w"), number(rotation, "x"), number(rotation, "y"),
                               number(rotation, "z"));
    if (!(std::abs(q.norm() - 1.0) <= kUnitTolerance)) return std::nullopt;  // also if it is NaN
    transform.linear() = q.normalized().toRotationMatrix();
  }
  if (const auto translation = pose.child("translation")) {
    transform.translation() =
        Eigen::Vector3d(number(translation, "x"), number(translation, "y"), number(translation, "z"));
  }
  if (!transform.matrix().allFinite()) return std::nullopt;
  return transform;
}

}  // namespace isthmus::io
