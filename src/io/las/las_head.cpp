#include "io/las/las_head.h"

#include <bit>
#include <cstring>
#include <limits>
#include <string_view>

namespace isthmus::io {
namespace {

static_assert(std::endian::native == std::endian::little, "binary records are written in this machine's byte order");

constexpr std::size_t kHeaderBytes = 375;  // of version 1.4
constexpr std::uint16_t kWktRecord = 2112, kGeoKeysRecord = 34735;

template <class T>
void put(std::string& out, std::size_t at, T value) {
  std::memcpy(out.data() + at, &value, sizeof(T));
}

/// Reserved 2, user 16, id 2, length 2, description 32, then the payload.
std::string variable_length_record(std::string_view user, std::uint16_t id, std::string_view description,
                                   std::string_view payload) {
  std::string record(54, '\0');
  std::memcpy(record.data() + 2, user.data(), user.size());
  put(record, 18, id);
  put(record, 20, static_cast<std::uint16_t>(payload.size()));
  std::memcpy(record.data() + 22, description.data(), description.size());
  return record.append(payload);
}

std::string crs_record(const std::optional<Crs>& crs) {
  constexpr std::string_view kUser = "LASF_Projection";
  if (!crs) return {};
  return crs->is_wkt() ? variable_length_record(kUser, kWktRecord, "OGC WKT", crs->text + '\0')
                       : variable_length_record(kUser, kGeoKeysRecord, "GeoTIFF keys", geo_key_directory(*crs));
}

}  // namespace

unsigned LasHead::format() const {
  const bool by_codes = crs && !crs->is_wkt();
  if (by_codes) return colour ? 2 : 0;
  return colour ? 7 : 6;
}

std::size_t LasHead::source_at() const { return format() < 6 ? 18 : 20; }

std::size_t LasHead::colour_at() const { return format() < 6 ? 20 : 30; }

std::size_t LasHead::record_bytes() const {
  const std::size_t without = format() < 6 ? 20 : 30;
  return colour ? without + 6 : without;
}

// Places of the fields: "LAS specification 1.4 - R15", ASPRS 2019, table 3.
std::string LasHead::bytes(std::uint64_t count, const Eigen::Array3d& low, const Eigen::Array3d& high) const {
  const std::string crs_bytes = crs_record(crs);
  std::string h(kHeaderBytes, '\0');
  std::memcpy(h.data(), "LASF", 4);
  constexpr std::uint16_t kWkt = 1 << 4;  // what point formats from 6 on require, also where no system is named
  constexpr unsigned kCompressed = 0x80;
  const bool old = format() < 6;
  put<std::uint16_t>(h, 6, old ? 0 : kWkt);
  put<std::uint8_t>(h, 24, 1);
  put<std::uint8_t>(h, 25, 4);
  std::memcpy(h.data() + 26, "MERGE", 5);
  std::memcpy(h.data() + 58, "isthmus", 7);
  put<std::uint16_t>(h, 94, kHeaderBytes);
  put(h, 96, static_cast<std::uint32_t>(kHeaderBytes + crs_bytes.size() + laz_record.size()));
  put<std::uint32_t>(h, 100, (crs_bytes.empty() ? 0 : 1) + (laz_record.empty() ? 0 : 1));
  put(h, 104, static_cast<std::uint8_t>(format() | (laz_record.empty() ? 0 : kCompressed)));
  put(h, 105, static_cast<std::uint16_t>(record_bytes()));
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    put<double>(h, 131 + 8 * k, kLasScale_m);
    put<double>(h, 155 + 8 * k, offset[axis]);
    put<double>(h, 179 + 16 * k, count > 0 ? high[axis] : 0.0);
    put<double>(h, 187 + 16 * k, count > 0 ? low[axis] : 0.0);
  }
  // Every point is the first and only return. The counts of 32 bits are for old formats, and only where they suffice.
  const bool narrow = old && count <= std::numeric_limits<std::uint32_t>::max();
  for (const std::size_t place : {107U, 111U}) put(h, place, narrow ? static_cast<std::uint32_t>(count) : 0U);
  for (const std::size_t place : {247U, 255U}) put<std::uint64_t>(h, place, count);
  return h + crs_bytes + laz_record;
}

}  // namespace isthmus::io
