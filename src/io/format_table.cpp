#include "io/format_table.h"

#include <algorithm>
#include <array>

#include "io/e57/e57_reader.h"
#include "io/kitti/kitti_reader.h"
#include "io/las/las_reader.h"
#include "io/las/laz.h"
#include "io/obj/obj_reader.h"
#include "io/pcd/pcd_reader.h"
#include "io/ply/ply_reader.h"
#include "io/ptx/ptx_reader.h"
#include "io/text/table_reader.h"
#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::array<Format, 11> kFormats = {{
    {"e57", "e57", "ASTM E57: scans with their poses, several in a file", open_e57, scans_of_e57},
    {"ptx", "ptx", "Leica PTX: gridded scans with their poses, several in a file", open_ptx, scans_of_ptx},
    {"ply", "ply", "Stanford polygon file: ascii, binary little and big endian", open_ply},
    {"pcd", "pcd", "PCL point cloud data: ascii, binary, binary_compressed", open_pcd},
    {"las", "las", "ASPRS LAS 1.0 to 1.4, point formats 0 to 10", open_las},
    {"laz", "laz", "ASPRS LAS compressed by LASzip", open_las},
    {"pts", "pts", "Leica PTS: a count, then x y z intensity r g b", open_pts},
    {"xyz", "xyz txt csv asc xyzi xyzn xyzrgb", "text table: delimiter and columns are detected", open_xyz},
    {"3dtk", "3d", "3DTK scan: centimetres, left-handed; read as metres, x forward, y left, z up", open_3dtk},
    {"kitti", "bin", "KITTI Velodyne: float32 x y z reflectance", open_kitti},
    {"obj", "obj", "Wavefront OBJ: its vertices", open_obj},
}};

constexpr std::string_view kUnsupported =
    "fls fws zfs zfc rxp rdbx rdb ptg ptb ptz rcs rcp lgs lgsx pod clr cl3 x3a imp";

std::string extension_of(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return lower_case(extension.empty() ? extension : extension.substr(1));
}

bool lists(std::string_view extensions, std::string_view extension) {
  const auto words = words_of(extensions);
  return std::find(words.begin(), words.end(), extension) != words.end();
}

bool is_laz(const Format& format) { return format.name == std::string_view("laz"); }

std::string readable_extensions() {
  std::string all;
  for (const Format& format : formats()) {
    for (const auto word : words_of(format.extensions)) all += (all.empty() ? "." : " .") + std::string(word);
  }
  return all;
}

}  // namespace

std::span<const Format> formats() {
  static const std::vector<Format> all = [] {
    std::vector<Format> some(kFormats.begin(), kFormats.end());
    if (!has_laz()) std::erase_if(some, is_laz);
    return some;
  }();
  return all;
}

Result<const Format*> format_of(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  for (const Format& format : kFormats) {
    if (lists(format.extensions, extension)) return &format;
  }
  const std::string what = extension.empty() ? "without an extension its format is not known"
                                             : "unsupported format " + in_quotes("." + extension);
  return fail(what, path.string(),
              (is_known_but_unsupported(path) ? "export it as E57 with its maker's program; " : "") +
                  ("readable: " + readable_extensions()));
}

std::size_t preference_of(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  std::size_t rank = 0;
  for (const Format& format : formats()) {
    for (const auto word : words_of(format.extensions)) {
      if (word == extension) return rank;
      ++rank;
    }
  }
  return rank;
}

bool is_known_but_unsupported(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return lists(kUnsupported, extension) || (extension == "laz" && !has_laz());
}

OpenedScan open_probing(const ScanRef& scan) {
  auto format = format_of(scan.path);
  if (!format) return tl::unexpected(std::move(format.error()));
  return (*format)->open(scan);
}

}  // namespace isthmus::io
