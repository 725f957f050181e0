#include "io/ply/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/field_role.h"
#include "io/line_reader.h"
#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::uint64_t kLongestHeaderBytes = std::uint64_t{1} << 20;

std::optional<ScalarType> type_of_name(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, ScalarType>, 20> kTypes = {{
      {"char", ScalarType::int8},       {"int8", ScalarType::int8},       {"uchar", ScalarType::uint8},
      {"uint8", ScalarType::uint8},     {"short", ScalarType::int16},     {"int16", ScalarType::int16},
      {"ushort", ScalarType::uint16},   {"uint16", ScalarType::uint16},   {"int", ScalarType::int32},
      {"int32", ScalarType::int32},     {"uint", ScalarType::uint32},     {"uint32", ScalarType::uint32},
      {"float", ScalarType::float32},   {"float32", ScalarType::float32}, {"double", ScalarType::float64},
      {"float64", ScalarType::float64}, {"int64", ScalarType::int64},     {"uint64", ScalarType::uint64},
      {"long", ScalarType::int64},      {"ulong", ScalarType::uint64},
  }};
  for (const auto& [known, type] : kTypes) {
    if (known == name) return type;
  }
  return std::nullopt;
}

Result<void> add_property(const std::vector<std::string_view>& words, PlyHeader& header, const std::string& where) {
  if (header.elements.empty()) return fail("a property before any element", where);
  PlyProperty property;
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3) return fail("a property line needs a type and a name", where);
  const std::string_view type_name = is_list ? words[3] : words[1];
  if (is_list) {
    property.list_count_type = type_of_name(words[2]);
    if (!property.list_count_type) return fail("unknown property type " + in_quotes(words[2]), where);
  }
  const auto type = type_of_name(type_name);
  if (!type) return fail("unknown property type " + in_quotes(type_name), where);
  property.type = *type;
  property.name = std::string(words.back());
  header.elements.back().properties.push_back(std::move(property));
  return {};
}

Result<void> add_element(const std::vector<std::string_view>& words, PlyHeader& header, const std::string& where) {
  if (words.size() != 3) return fail("an element line needs a name and a count", where);
  const auto count = whole_number<std::uint64_t>(words[2]);
  if (!count) return fail(in_quotes(words[2]) + " is no count of elements", where);
  header.elements.push_back({std::string(words[1]), *count, {}});
  return {};
}

Result<void> set_encoding(const std::vector<std::string_view>& words, PlyHeader& header, const std::string& where) {
  const std::string_view name = words.size() > 1 ? words[1] : std::string_view();
  if (name == "ascii") {
    header.encoding = PlyHeader::Encoding::ascii;
  } else if (name == "binary_little_endian") {
    header.encoding = PlyHeader::Encoding::little_endian;
  } else if (name == "binary_big_endian") {
    header.encoding = PlyHeader::Encoding::big_endian;
  } else {
    return fail("unknown format " + in_quotes(name), where, "known: ascii, binary_little_endian, binary_big_endian");
  }
  return {};
}

// One header line after "ply"; true at end_header.
Result<bool> take_line(std::string_view line, PlyHeader& header, bool& has_format, const std::string& where) {
  const auto words = words_of(line);
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return false;
  Result<void> taken;
  if (words[0] == "end_header") return true;
  if (words[0] == "format") {
    has_format = true;
    taken = set_encoding(words, header, where);
  } else if (words[0] == "element") {
    taken = add_element(words, header, where);
  } else if (words[0] == "property") {
    taken = add_property(words, header, where);
  } else {
    header.notes.push_back("header line " + in_quotes(line) + " is unknown and ignored");
  }
  if (!taken) return tl::unexpected(std::move(taken.error()));
  return false;
}

Result<void> find_vertices(PlyHeader& header, const std::string& file) {
  std::string names;
  for (std::size_t i = 0; i < header.elements.size(); ++i) {
    const PlyElement& element = header.elements[i];
    if (element.name != "vertex") {
      names += (names.empty() ? "" : ", ") + element.name;
      continue;
    }
    header.vertex = i;
    bool has_x = false, has_y = false;
    for (const PlyProperty& property : element.properties) {
      has_x |= !property.list_count_type && role_of_field(property.name) == FieldRole::x;
      has_y |= !property.list_count_type && role_of_field(property.name) == FieldRole::y;
    }
    if (!has_x || !has_y) return fail("the vertex element has no properties x and y", file);
    return {};
  }
  return fail("no vertex element", file, names.empty() ? "the header lists no elements" : "its elements: " + names);
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(), [](const auto& p) { return p.list_count_type.has_value(); });
}

std::uint64_t PlyElement::fixed_bytes() const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += bytes_of(property.type);
  return bytes;
}

Result<PlyHeader> read_ply_header(InputFile& file) {
  LineReader lines(file);
  PlyHeader header;
  std::string_view line;
  auto got = lines.next(line);
  if (!got || !*got || trimmed(line) != "ply") {
    return fail("no PLY file: it starts with " + in_quotes(got ? line : std::string_view()), at_line(file.name(), 1));
  }
  bool has_format = false;
  for (;;) {
    got = lines.next(line);
    if (!got) return tl::unexpected(std::move(got.error()));
    if (!*got || lines.next_offset() > kLongestHeaderBytes) {
      return fail("the PLY header has no end_header", at_line(file.name(), lines.number()));
    }
    auto ended = take_line(line, header, has_format, at_line(file.name(), lines.number()));
    if (!ended) return tl::unexpected(std::move(ended.error()));
    if (*ended) break;
  }
  if (!has_format) return fail("the PLY header has no format line", file.name());
  if (auto found = find_vertices(header, file.name()); !found) return tl::unexpected(std::move(found.error()));
  header.data_begin = lines.next_offset();
  header.data_line = lines.number() + 1;
  return header;
}

}  // namespace isthmus::io
