#include "io/crs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "io/text_number.h"
#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr const char* kHint = "give EPSG:25832, EPSG:25832+7837, WKT, or a file of WKT (.prj)";

// Of WKT 1 (OGC 01-009) and WKT 2 (OGC 18-010).
constexpr std::array<std::string_view, 19> kKeywords = {
    "PROJCS",   "PROJCRS",        "PROJECTEDCRS", "GEOGCS",      "GEOGCRS",           "GEOGRAPHICCRS", "GEOCCS",
    "GEODCRS",  "GEODETICCRS",    "COMPD_CS",     "COMPOUNDCRS", "LOCAL_CS",          "ENGCRS",        "ENGINEERINGCRS",
    "BOUNDCRS", "DERIVEDPROJCRS", "FITTED_CS",    "VERT_CS",     "COORDINATEMETADATA"};

std::optional<std::uint16_t> code_of(std::string_view text) {
  const auto code = whole_number<std::uint16_t>(text);
  // 0 and what lies above are GeoTIFF's words for undefined and private systems.
  return code && *code > 0 && *code < 32767 ? code : std::nullopt;
}

Result<Crs> from_codes(std::string_view text) {
  constexpr std::string_view kPrefix = "EPSG:";
  const std::string_view codes = text.substr(kPrefix.size());
  const std::size_t plus = codes.find('+');
  Crs crs;
  crs.epsg = code_of(codes.substr(0, plus));
  if (plus != std::string_view::npos) crs.vertical_epsg = code_of(codes.substr(plus + 1));
  if (!crs.epsg || (plus != std::string_view::npos && !crs.vertical_epsg))
    return fail(in_quotes(text) + " names no coordinate reference system: codes are numbers from 1 to 32766", {},
                kHint);
  crs.text =
      crs.vertical_epsg ? fmt::format("EPSG:{}+{}", *crs.epsg, *crs.vertical_epsg) : fmt::format("EPSG:{}", *crs.epsg);
  return crs;
}

/// Whether every bracket is closed by its like, the last one at the end; quoted text does not count.
bool brackets_close(std::string_view text) {
  std::string open;
  bool quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (c == '"') quoted = !quoted;
    if (quoted) continue;
    if (c == '[' || c == '(') open += c == '[' ? ']' : ')';
    if (c != ']' && c != ')') continue;
    if (open.empty() || open.back() != c) return false;
    open.pop_back();
    if (open.empty() && k + 1 < text.size()) return false;
  }
  return open.empty() && !quoted;
}

}  // namespace

Result<Crs> parse_crs(std::string_view whole) {
  std::string_view text = trimmed(whole);
  while (!text.empty() && text.back() == '\n') text = trimmed(text.substr(0, text.size() - 1));
  while (!text.empty() && text.front() == '\n') text = trimmed(text.substr(1));
  if (lower_case(text.substr(0, 5)) == "epsg:") return from_codes(text);
  const std::string_view keyword = trimmed(text.substr(0, text.find_first_of("[(")));
  const bool known =
      std::ranges::any_of(kKeywords, [&](std::string_view word) { return lower_case(word) == lower_case(keyword); });
  if (!known || keyword.size() == text.size())
    return fail(in_quotes(text) + " names no coordinate reference system", {}, kHint);
  constexpr std::size_t kMostBytes = 65534;  // what a variable length record of LAS holds, with the zero behind it
  if (text.size() > kMostBytes)
    return fail(fmt::format("{} bytes of WKT are too many for LAS", text.size()), {}, kHint);
  if (!brackets_close(text)) return fail("the WKT's brackets or quotes do not close: " + in_quotes(text), {}, kHint);
  Crs crs;
  crs.text = text;
  return crs;
}

std::string geo_key_directory(const Crs& crs) {
  // Key, its value being here (0), one of it, the value; keys ascend.
  constexpr std::uint16_t kModel = 1024, kRaster = 1025, kProjected = 3072, kUnits = 3076, kVertical = 4096,
                          kVerticalUnits = 4099, kMetre = 9001;
  std::vector<std::array<std::uint16_t, 4>> keys = {
      {kModel, 0, 1, 1}, {kRaster, 0, 1, 1}, {kProjected, 0, 1, crs.epsg.value_or(0)}, {kUnits, 0, 1, kMetre}};
  if (crs.vertical_epsg) {
    keys.push_back({kVertical, 0, 1, *crs.vertical_epsg});
    keys.push_back({kVerticalUnits, 0, 1, kMetre});
  }
  keys.insert(keys.begin(), {1, 1, 0, static_cast<std::uint16_t>(keys.size())});  // version 1, revision 1.0
  std::string bytes(8 * keys.size(), '\0');
  for (std::size_t k = 0; k < keys.size(); ++k) std::memcpy(bytes.data() + 8 * k, keys[k].data(), 8);
  return bytes;
}

}  // namespace isthmus::io
