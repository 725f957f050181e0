#include "io/e57/e57_xml_writer.h"

#include <fmt/format.h>

namespace isthmus::io {

pugi::xml_node append_e57_node(pugi::xml_node parent, const char* name, const char* type) {
  pugi::xml_node node = parent.append_child(name);
  node.append_attribute("type") = type;
  return node;
}

void append_e57_string(pugi::xml_node parent, const char* name, const std::string& text) {
  append_e57_node(parent, name, "String").append_child(pugi::node_cdata).set_value(text.c_str());
}

void append_e57_integer(pugi::xml_node parent, const char* name, std::int64_t value) {
  append_e57_node(parent, name, "Integer").text().set(fmt::format("{}", value).c_str());
}

void append_e57_float(pugi::xml_node parent, const char* name, double value) {
  append_e57_node(parent, name, "Float").text().set(fmt::format("{}", value).c_str());
}

void set_e57_pose(pugi::xml_node parent, const Transform& pose) {
  pugi::xml_node node = parent.child("pose");
  if (!node) {
    node = parent.child("points") ? parent.insert_child_before("pose", parent.child("points"))
                                  : parent.append_child("pose");
    node.append_attribute("type") = "Structure";
  }
  node.remove_children();
  Eigen::Quaterniond q(pose.linear());
  q.normalize();
  if (q.w() < 0.0) q.coeffs() *= -1.0;  // of the two that mean the same
  pugi::xml_node rotation = append_e57_node(node, "rotation", "Structure");
  append_e57_float(rotation, "w", q.w());
  append_e57_float(rotation, "x", q.x());
  append_e57_float(rotation, "y", q.y());
  append_e57_float(rotation, "z", q.z());
  pugi::xml_node translation = append_e57_node(node, "translation", "Structure");
  append_e57_float(translation, "x", pose.translation().x());
  append_e57_float(translation, "y", pose.translation().y());
  append_e57_float(translation, "z", pose.translation().z());
}

std::string e57_guid(const Digest& digest) {
  const std::string hex = digest.hex();
  const std::string_view digits = hex;
  return fmt::format("{{{}-{}-{}-{}-{}}}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                     digits.substr(16, 4), digits.substr(20));
}

std::string e57_xml_text(const pugi::xml_document& document, bool as_it_is) {
  struct Text final : pugi::xml_writer {
    std::string all;
    void write(const void* data, std::size_t size) override { all.append(static_cast<const char*>(data), size); }
  } text;
  document.save(text, "  ", as_it_is ? pugi::format_raw : pugi::format_indent, pugi::encoding_utf8);
  return std::move(text.all);
}

}  // namespace isthmus::io
