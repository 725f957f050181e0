#include "io/e57/e57_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "io/e57/e57_file.h"
#include "io/e57/e57_page_writer.h"
#include "io/e57/e57_xml.h"
#include "io/e57/e57_xml_writer.h"

namespace isthmus::io {
namespace {

constexpr std::size_t kCopiedAtOnce = std::size_t{1} << 16;

std::vector<pugi::xml_node> elements(const pugi::xml_node& vector) {
  std::vector<pugi::xml_node> all;
  for (const pugi::xml_node& child : vector.children()) {
    if (child.type() == pugi::node_element) all.push_back(child);
  }
  return all;
}

// Poses of images are stored in the file's frame, not relative to their scan.
void move_images(const pugi::xml_node& root, const std::string& scan_guid, const Transform& new_from_old) {
  for (const pugi::xml_node& image : elements(root.child("images2D"))) {
    if (scan_guid.empty() || scan_guid != e57_text(image.child("associatedData3DGuid"))) continue;
    if (const auto pose = e57_pose(image.child("pose"))) set_e57_pose(image, orthonormalised(new_from_old * *pose));
  }
}

void leave_out(pugi::xml_node root, const pugi::xml_node& scan) {
  const std::string guid = e57_text(scan.child("guid"));
  for (const pugi::xml_node& image : elements(root.child("images2D"))) {
    if (guid.empty() || guid != e57_text(image.child("associatedData3DGuid"))) continue;
    root.child("images2D").remove_child(image);
  }
  root.child("data3D").remove_child(scan);
}

// Another file, another guid.
void change_guid(pugi::xml_node root, const std::vector<std::optional<Transform>>& poses) {
  Digest digest;
  digest.add(e57_text(root.child("guid")));
  for (const auto& pose : poses) {
    digest.add(pose.has_value());
    if (pose) digest.add_bytes(pose->matrix().data(), 16 * sizeof(double));
  }
  if (root.child("guid")) root.child("guid").text().set(e57_guid(digest).c_str());
}

void set_coordinates(pugi::xml_node root, const std::string& coordinates) {
  root.remove_child("coordinateMetadata");
  append_e57_string(root, "coordinateMetadata", coordinates);
}

/// Sections and images stand behind the XML section, which usually ends the file.
bool refers_behind_xml(const pugi::xml_document& document, const E57File& file) {
  return !!document.find_node(
      [&](const pugi::xml_node& node) { return node.attribute("fileOffset").as_ullong() > file.header.xml_physical; });
}

Result<std::string> with_poses(const E57File& file, const std::vector<std::optional<Transform>>& poses,
                               ScansWithoutPose without, const std::string& coordinates, pugi::xml_document& document) {
  if (auto parsed = parse_e57_xml(file.xml, file.pages.name(), true, document); !parsed) {
    return tl::unexpected(std::move(parsed.error()));
  }
  const pugi::xml_node root = document.child("e57Root");
  const std::vector<pugi::xml_node> scans = elements(root.child("data3D"));
  if (scans.size() != poses.size()) {
    return fail(fmt::format("{} poses for {} scans", poses.size(), scans.size()), file.pages.name());
  }
  for (std::size_t k = 0; k < scans.size(); ++k) {
    if (!poses[k]) {
      if (without == ScansWithoutPose::left_out) leave_out(root, scans[k]);
      continue;
    }
    const Transform old = e57_pose(scans[k].child("pose")).value_or(Transform::Identity());
    move_images(root, e57_text(scans[k].child("guid")), *poses[k] * old.inverse());
    set_e57_pose(scans[k], *poses[k]);
  }
  change_guid(root, poses);
  if (!coordinates.empty()) set_coordinates(root, coordinates);
  return e57_xml_text(document, true);
}

}  // namespace

Result<void> copy_e57_with_poses(const std::filesystem::path& from, const std::filesystem::path& to,
                                 const std::vector<std::optional<Transform>>& file_from_scan, ScansWithoutPose without,
                                 const std::string& coordinates) {
  auto file = open_e57_file(from);
  if (!file) return tl::unexpected(std::move(file.error()));
  pugi::xml_document document;
  const auto xml = with_poses(*file, file_from_scan, without, coordinates, document);
  if (!xml) return tl::unexpected(xml.error());
  // An XML section at the end is replaced; elsewhere the old one stays as bytes that nothing refers to.
  const std::uint64_t end =
      refers_behind_xml(document, *file) ? file->pages.logical_size() : e57_logical(file->header.xml_physical);
  auto writer = E57PageWriter::create(to);
  if (!writer) return tl::unexpected(std::move(writer.error()));
  std::string bytes;
  for (std::uint64_t place = kE57HeaderBytes; place < end; place += bytes.size()) {
    bytes.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kCopiedAtOnce, end - place)));
    if (auto read = file->pages.read(place, bytes.data(), bytes.size()); !read) return read;
    if (auto appended = writer->append(bytes); !appended) return appended;
  }
  return writer->publish(*xml);
}

}  // namespace isthmus::io
