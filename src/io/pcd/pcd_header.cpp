#include "io/pcd/pcd_header.h"

#include <fmt/format.h>

#include <limits>

#include "io/field_role.h"
#include "io/line_reader.h"
#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::uint64_t kLongestHeaderBytes = std::uint64_t{1} << 20;
constexpr std::uint32_t kMostNumbersPerField = 1U << 16;

using Words = std::vector<std::string_view>;

// What the header lines say before they are put together.
struct RawHeader {
  std::vector<std::string> names, sizes, types, counts;
  std::optional<std::uint64_t> width, height, points;
};

std::vector<std::string> rest_of(const Words& words) { return {words.begin() + 1, words.end()}; }

std::optional<ScalarType> type_of(std::string_view letter, std::string_view size) {
  const bool is_signed = letter == "I" || letter == "i";
  const bool is_unsigned = letter == "U" || letter == "u";
  if (letter == "F" || letter == "f") {
    if (size == "4") return ScalarType::float32;
    if (size == "8") return ScalarType::float64;
  } else if (is_signed || is_unsigned) {
    if (size == "1") return is_signed ? ScalarType::int8 : ScalarType::uint8;
    if (size == "2") return is_signed ? ScalarType::int16 : ScalarType::uint16;
    if (size == "4") return is_signed ? ScalarType::int32 : ScalarType::uint32;
    if (size == "8") return is_signed ? ScalarType::int64 : ScalarType::uint64;
  }
  return std::nullopt;
}

Result<void> take_count(const Words& words, std::optional<std::uint64_t>& count, const std::string& where) {
  count = words.size() == 2 ? whole_number<std::uint64_t>(words[1]) : std::nullopt;
  if (!count) return fail("no count after " + std::string(words[0]), where);
  return {};
}

Result<void> take_viewpoint(const Words& words, PcdHeader& header, const std::string& where) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto value = axis + 1 < words.size() ? whole_number<double>(words[axis + 1]) : std::nullopt;
    if (!value) return fail("VIEWPOINT needs numbers tx ty tz qw qx qy qz", where);
    position[static_cast<Eigen::Index>(axis)] = *value;
  }
  if (position.allFinite() && !position.isZero(0.0)) header.viewpoint = position;
  return {};
}

Result<void> take_data(const Words& words, PcdHeader& header, const std::string& where) {
  const std::string_view kind = words.size() > 1 ? words[1] : std::string_view();
  if (kind == "ascii") {
    header.data = PcdHeader::Data::ascii;
  } else if (kind == "binary") {
    header.data = PcdHeader::Data::binary;
  } else if (kind == "binary_compressed") {
    header.data = PcdHeader::Data::binary_compressed;
  } else {
    return fail("unknown DATA kind " + in_quotes(kind), where, "known: ascii, binary, binary_compressed");
  }
  return {};
}

Result<void> take_line(const Words& words, RawHeader& raw, PcdHeader& header, const std::string& where) {
  const std::string_view key = words[0];
  if (key == "FIELDS" || key == "COLUMNS") raw.names = rest_of(words);
  if (key == "SIZE") raw.sizes = rest_of(words);
  if (key == "TYPE") raw.types = rest_of(words);
  if (key == "COUNT") raw.counts = rest_of(words);
  if (key == "WIDTH") return take_count(words, raw.width, where);
  if (key == "HEIGHT") return take_count(words, raw.height, where);
  if (key == "POINTS") return take_count(words, raw.points, where);
  if (key == "VIEWPOINT") return take_viewpoint(words, header, where);
  if (key == "DATA") return take_data(words, header, where);
  return {};
}

Result<void> put_fields(const RawHeader& raw, PcdHeader& header, const std::string& file) {
  const std::size_t n = raw.names.size();
  if (n == 0) return fail("the PCD header has no FIELDS", file);
  if (raw.sizes.size() != n || raw.types.size() != n || (!raw.counts.empty() && raw.counts.size() != n)) {
    return fail(fmt::format("the PCD header has {} FIELDS, {} SIZE, {} TYPE and {} COUNT entries", n, raw.sizes.size(),
                            raw.types.size(), raw.counts.size()),
                file);
  }
  bool has_x = false, has_y = false;
  for (std::size_t i = 0; i < n; ++i) {
    PcdField field;
    field.name = raw.names[i];
    const auto type = type_of(raw.types[i], raw.sizes[i]);
    if (!type)
      return fail("unknown type " + in_quotes(raw.types[i] + raw.sizes[i]) + " of field " + in_quotes(field.name),
                  file);
    field.type = *type;
    const auto count = raw.counts.empty() ? std::optional(1U) : whole_number<std::uint32_t>(raw.counts[i]);
    if (!count || *count > kMostNumbersPerField) return fail("bad COUNT " + in_quotes(raw.counts[i]), file);
    field.count = *count;
    has_x |= role_of_field(field.name) == FieldRole::x && field.count > 0;
    has_y |= role_of_field(field.name) == FieldRole::y && field.count > 0;
    header.fields.push_back(std::move(field));
  }
  if (!has_x || !has_y) return fail("the PCD header has no fields x and y", file);
  return {};
}

Result<void> put_points(const RawHeader& raw, PcdHeader& header, const std::string& file) {
  std::optional<std::uint64_t> area;
  if (raw.width) {
    const std::uint64_t height = raw.height.value_or(1);
    if (height != 0 && *raw.width > std::numeric_limits<std::uint64_t>::max() / height) {
      return fail("WIDTH times HEIGHT overflows", file);
    }
    area = *raw.width * height;
  }
  if (!raw.points && !area) return fail("the PCD header has neither POINTS nor WIDTH", file);
  header.num_points = raw.points ? *raw.points : *area;
  if (raw.points && area && *area != *raw.points) {
    header.notes.push_back(fmt::format("POINTS {} is not WIDTH x HEIGHT = {}: POINTS is believed", *raw.points, *area));
  }
  return {};
}

}  // namespace

std::size_t PcdHeader::bytes_per_point() const {
  std::size_t bytes = 0;
  for (const PcdField& field : fields) bytes += field.bytes();
  return bytes;
}

Result<PcdHeader> read_pcd_header(InputFile& file) {
  LineReader lines(file);
  PcdHeader header;
  RawHeader raw;
  for (std::string_view line;;) {
    auto got = lines.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got || lines.next_offset() > kLongestHeaderBytes) {
      return fail("no PCD header: no DATA line found", at_line(file.name(), lines.number()));
    }
    const Words words = words_of(line);
    if (words.empty() || words[0].front() == '#') continue;
    const std::string where = at_line(file.name(), lines.number());
    if (words[0].front() < 'A' || words[0].front() > 'Z') return fail("no PCD header: " + in_quotes(line), where);
    if (auto taken = take_line(words, raw, header, where); !taken) return tl::unexpected(std::move(taken.error()));
    if (words[0] == "DATA") break;
  }
  if (auto put = put_fields(raw, header, file.name()); !put) return tl::unexpected(std::move(put.error()));
  if (auto put = put_points(raw, header, file.name()); !put) return tl::unexpected(std::move(put.error()));
  header.data_begin = lines.next_offset();
  header.data_line = lines.number() + 1;
  return header;
}

}  // namespace isthmus::io
