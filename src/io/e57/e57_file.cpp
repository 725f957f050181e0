#include "io/e57/e57_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "io/wording.h"

namespace isthmus::io {
namespace {

constexpr std::string_view kSignature = "ASTM-E57";
constexpr std::uint64_t kMostXmlBytes = std::uint64_t{1} << 30;  // it is held in memory; real ones have some kilobytes

using Raw = std::array<char, kE57HeaderBytes>;

template <class T>
T at(const Raw& raw, std::size_t offset) {
  T value;
  std::memcpy(&value, raw.data() + offset, sizeof(T));
  return value;
}

Result<Raw> raw_header(const InputFile& file) {
  Raw raw = {};
  const auto available = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), raw.size()));
  if (auto read = file.read_at(0, raw.data(), available); !read) return tl::unexpected(std::move(read.error()));
  if (std::string_view(raw.data(), kSignature.size()) != kSignature) {
    return fail("no E57 file: it starts with " + in_quotes({raw.data(), std::min(available, kSignature.size())}),
                at_byte(file.name(), 0));
  }
  if (file.size() < kE57PageBytes) {
    return fail(fmt::format("the file ends inside its first page, after {} bytes", file.size()),
                at_byte(file.name(), file.size()), "the file is cut short: copy or export it again");
  }
  return raw;
}

Result<void> check(const E57Header& header, std::uint64_t page_bytes, const std::string& file, std::uint64_t size) {
  if (header.major != 1) {
    return fail(fmt::format("unsupported format: E57 version {}.{}", header.major, header.minor), at_byte(file, 8),
                "version 1 is read");
  }
  if (page_bytes != kE57PageBytes) {
    return fail(fmt::format("unsupported format: E57 pages of {} bytes", page_bytes), at_byte(file, 40),
                "pages of 1024 bytes are read");
  }
  if (header.file_bytes > size) {
    return fail(fmt::format("the header says {} bytes, the file holds {}", header.file_bytes, size),
                at_byte(file, size), "the file is cut short: copy or export it again");
  }
  if (header.file_bytes == 0 || header.file_bytes % kE57PageBytes != 0) {
    return fail(fmt::format("a length of {} bytes is not a whole number of pages", header.file_bytes),
                at_byte(file, 16));
  }
  const bool in_checksum = header.xml_physical % kE57PageBytes >= kE57PageData;
  const std::uint64_t logical_size = header.file_bytes / kE57PageBytes * kE57PageData;
  if (in_checksum || header.xml_physical < kE57HeaderBytes || header.xml_physical >= header.file_bytes ||
      header.xml_bytes > logical_size - e57_logical(header.xml_physical) || header.xml_bytes > kMostXmlBytes) {
    return fail(fmt::format("an XML section of {} bytes at byte {} cannot be in a file of {} bytes", header.xml_bytes,
                            header.xml_physical, header.file_bytes),
                at_byte(file, 24));
  }
  return {};
}

}  // namespace

Result<E57File> open_e57_file(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  const auto raw = raw_header(*file);
  if (!raw) return tl::unexpected(raw.error());
  const std::uint64_t size = file->size();
  // The checksum first: a damaged header should not be answered with what its damaged numbers say.
  E57File e57 = {E57Pages(std::move(*file), size), {}, {}};
  char header_byte = 0;
  if (auto good = e57.pages.read(0, &header_byte, 1); !good) return tl::unexpected(std::move(good.error()));
  const E57Header header = {at<std::uint32_t>(*raw, 8), at<std::uint32_t>(*raw, 12), at<std::uint64_t>(*raw, 16),
                            at<std::uint64_t>(*raw, 24), at<std::uint64_t>(*raw, 32)};
  if (auto good = check(header, at<std::uint64_t>(*raw, 40), e57.pages.name(), size); !good) {
    return tl::unexpected(std::move(good.error()));
  }
  e57.pages.end_at(header.file_bytes);
  e57.header = header;
  e57.xml.resize(static_cast<std::size_t>(header.xml_bytes));
  if (auto read = e57.pages.read(e57_logical(header.xml_physical), e57.xml.data(), e57.xml.size()); !read) {
    return tl::unexpected(std::move(read.error()));
  }
  return e57;
}

std::string e57_header_bytes(const E57Header& header) {
  std::string bytes(kSignature);
  const auto append = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
  append(header.major);
  append(header.minor);
  append(header.file_bytes);
  append(header.xml_physical);
  append(header.xml_bytes);
  append(kE57PageBytes);
  return bytes;
}

}  // namespace isthmus::io
