#include "store/store.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <array>
#include <system_error>

#include "base/atomic_file.h"
#include "base/digest.h"
#include "base/disk_space.h"

namespace isthmus::store {
namespace {

constexpr std::array<char, 8> kMagic = {'i', 's', 't', 'h', 'm', 'u', 's', 'A'};
constexpr std::uint32_t kFormat = 1;
constexpr std::size_t kChecksumBytes = sizeof(XXH128_canonical_t);

struct Envelope {
  std::array<char, 8> magic = kMagic;
  std::uint32_t format = kFormat;
  std::string key;
  std::string payload;
  template <class F>
  void fields(F&& f) {
    f(magic), f(format), f(key), f(payload);
  }
};

std::string text_of(const Key& key) { return key.stage + "/" + key.digest; }

std::string checksum(std::string_view bytes) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  return {reinterpret_cast<const char*>(canonical.digest), kChecksumBytes};
}

Result<std::string> unwrap(const std::string& file, const std::string& key_text) {
  if (file.size() < kChecksumBytes) return fail(fmt::format("it ends after {} bytes", file.size()));
  const std::string_view content(file.data(), file.size() - kChecksumBytes);
  if (checksum(content) != std::string_view(file).substr(content.size())) {
    return fail("its checksum does not fit its content");
  }
  Envelope envelope;
  ArchiveReader reader(content);
  reader(envelope);
  if (envelope.magic != kMagic) return fail("it is no artifact of isthmus");
  if (envelope.format != kFormat) return fail(fmt::format("its format {} is not {}", envelope.format, kFormat));
  if (!reader.complete()) return fail("its parts do not fit its length");
  if (envelope.key != key_text) return fail(fmt::format("it was stored as {}", envelope.key));
  return std::move(envelope.payload);
}

}  // namespace

Key make_key(std::string_view stage, std::string_view version, std::span<const std::string> inputs) {
  Digest digest;
  digest.add(stage).add(version).add(static_cast<std::uint64_t>(inputs.size()));
  for (const std::string& input : inputs) digest.add(input);
  return {std::string(stage), digest.hex()};
}

Result<Store> Store::open(const std::filesystem::path& folder, OnTrouble on_trouble) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    return tl::unexpected(write_error("the store's folder cannot be created", error.value(), folder));
  }
  return Store(folder, std::move(on_trouble));
}

std::filesystem::path Store::path_of(const Key& key) const {
  return folder_ / key.stage / key.digest.substr(0, 2) / (key.digest + ".artifact");
}

std::optional<std::string> Store::load_payload(const Key& key) const {
  if (folder_.empty()) return std::nullopt;
  const std::filesystem::path path = path_of(key);
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return std::nullopt;
  const Result<std::string> file = read_file(path);
  if (!file) {
    report_damage(key, file.error().what);
    return std::nullopt;
  }
  Result<std::string> payload = unwrap(*file, text_of(key));
  if (payload) return std::move(*payload);
  report_damage(key, payload.error().what);
  return std::nullopt;
}

Result<void> Store::save_payload(const Key& key, const std::string& payload) const {
  if (folder_.empty()) return {};
  const std::filesystem::path path = path_of(key);
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  if (error) return tl::unexpected(write_error("cannot be created", error.value(), path.parent_path()));
  Envelope envelope;
  envelope.key = text_of(key);
  envelope.payload = payload;
  std::string bytes = to_bytes(envelope);
  bytes += checksum(bytes);
  return write_file_atomically(path, bytes);
}

void Store::report_damage(const Key& key, const std::string& reason) const {
  if (on_trouble_) on_trouble_({"damaged artifact: " + reason, path_of(key).string(), "it is made anew"});
}

void Store::report_unkept(const Error& error) const {
  if (!on_trouble_) return;
  std::call_once(*unkept_reported_, [&] {
    on_trouble_({"what was computed cannot be kept: " + error.what, error.where,
                 "the run goes on, but a later one begins anew; free some space or choose another --store"});
  });
}

}  // namespace isthmus::store
