#include "io/las/las_reader.h"

#include <utility>

#include "io/las/las_header.h"
#include "io/las/laz.h"
#include "io/record_reader.h"

namespace isthmus::io {
namespace {

RecordLayout layout_of(const LasHeader& las) {
  const std::size_t step = las.record_bytes;
  RecordLayout layout;
  layout.bytes_per_record = step;
  const auto axis = [&](std::size_t a) {
    return RecordField{ScalarType::int32, 4 * a, step, las.scale[a], las.offset[a]};
  };
  layout.x = axis(0);
  layout.y = axis(1);
  layout.z = axis(2);
  layout.intensity = RecordField{ScalarType::uint16, 12, step};
  if (const std::size_t colour = las.point_format().colour; colour != 0) {
    layout.colour = {RecordField{ScalarType::uint16, colour, step}, RecordField{ScalarType::uint16, colour + 2, step},
                     RecordField{ScalarType::uint16, colour + 4, step}};
  }
  return layout;
}

}  // namespace

OpenedScan open_las(const ScanRef& scan) {
  auto file = InputFile::open(scan.path);
  if (!file) return tl::unexpected(std::move(file.error()));
  auto las = read_las_header(*file);
  if (!las) return tl::unexpected(std::move(las.error()));
  if (las->compressed) return open_laz(std::move(*file), *las);
  return open_records(std::move(*file), scan_header_of(*las), layout_of(*las), {las->points_begin, las->num_points});
}

}  // namespace isthmus::io
