#include "io/e57/e57_page_writer.h"

#include <algorithm>
#include <utility>

namespace isthmus::io {
namespace {

constexpr std::size_t kPendingBytes = std::size_t{256} * kE57PageBytes;

/// The page with its checksum behind it.
std::string sealed(std::string page) {
  const std::uint32_t crc = crc32c(page);
  for (const int shift : {24, 16, 8, 0}) page += static_cast<char>(crc >> shift & 0xFF);
  return page;
}

}  // namespace

Result<E57PageWriter> E57PageWriter::create(const std::filesystem::path& path) {
  auto file = OutputFile::create(path);
  if (!file) return tl::unexpected(std::move(file.error()));
  E57PageWriter writer(std::move(*file));
  if (auto header = writer.reserve(kE57HeaderBytes); !header) return tl::unexpected(std::move(header.error()));
  return writer;
}

Result<void> E57PageWriter::flush() {
  auto written = file_.write(pending_);
  pending_.clear();
  return written;
}

Result<void> E57PageWriter::end_page() {
  page_.resize(kE57PageData, '\0');
  if (std::exchange(keep_page_, false)) kept_[page_number_] = page_;
  pending_ += sealed(std::exchange(page_, {}));
  ++page_number_;
  return pending_.size() < kPendingBytes ? Result<void>() : flush();
}

Result<void> E57PageWriter::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t length = std::min<std::size_t>(bytes.size(), kE57PageData - page_.size());
    page_ += bytes.substr(0, length);
    bytes.remove_prefix(length);
    if (page_.size() < kE57PageData) continue;
    if (auto ended = end_page(); !ended) return ended;
  }
  return {};
}

Result<void> E57PageWriter::align() {
  constexpr std::uint64_t kAlignment = 4;
  return append(std::string((kAlignment - logical() % kAlignment) % kAlignment, '\0'));
}

Result<std::uint64_t> E57PageWriter::reserve(std::size_t n) {
  if (page_.size() + n > kE57PageData) {
    if (auto ended = end_page(); !ended) return tl::unexpected(std::move(ended.error()));
  }
  const std::uint64_t place = logical();
  keep_page_ = true;
  if (auto appended = append(std::string(n, '\0')); !appended) return tl::unexpected(std::move(appended.error()));
  return place;
}

Result<void> E57PageWriter::fill_in(std::uint64_t logical, std::string_view bytes) {
  const std::uint64_t number = logical / kE57PageData;
  const auto place = static_cast<std::size_t>(logical % kE57PageData);
  std::string& page = number == page_number_ ? page_ : kept_.at(number);
  page.replace(place, bytes.size(), bytes);
  if (number == page_number_) return {};
  if (auto flushed = flush(); !flushed) return flushed;
  return file_.overwrite(number * kE57PageBytes, sealed(page));
}

Result<void> E57PageWriter::publish(std::string_view xml) {
  if (auto aligned = align(); !aligned) return aligned;
  E57Header header;
  header.xml_physical = e57_physical(logical());
  header.xml_bytes = xml.size();
  if (auto appended = append(xml); !appended) return appended;
  if (!page_.empty()) {
    if (auto ended = end_page(); !ended) return ended;
  }
  header.file_bytes = page_number_ * kE57PageBytes;
  if (auto filled = fill_in(0, e57_header_bytes(header)); !filled) return filled;
  return file_.publish();
}

}  // namespace isthmus::io
