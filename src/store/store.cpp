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
  Result<StoreLock> lock = StoreLock::take(folder, StoreLock::Kind::shared);
  if (!lock) return tl::unexpected(lock.error());
  return Store(folder, std::move(on_trouble), std::make_shared<StoreLock>(std::move(*lock)));
}

std::filesystem::path Store::path_of(const Key& key) const {
  return folder_ / key.stage / key.digest.substr(0, 2) / (key.digest + ".artifact");
}

bool Store::contains(const Key& key) const {
  std::error_code error;
  return !folder_.empty() && std::filesystem::exists(path_of(key), error);
}

void Store::need(const Key& key) const {
  if (journal_) journal_->write_once({0, "needed", key.stage, key.digest, "", 0});
}

void Store::add_user(const std::filesystem::path& output) const {
  if (folder_.empty()) return;
  const std::string path = std::filesystem::absolute(output).lexically_normal().string();
  const std::filesystem::path file = folder_ / "users" / (Digest().add(path).hex() + ".txt");
  std::error_code error;
  if (std::filesystem::exists(file, error)) return;
  std::filesystem::create_directories(file.parent_path(), error);
  if (const Result<void> written = write_file_atomically(file, path + "\n"); !written) report_unkept(written.error());
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
  if (payload) {
    if (journal_) journal_->write_once({0, "found", key.stage, key.digest, "", 0});
    return std::move(*payload);
  }
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
  if (journal_)
    journal_->write({0, "kept", key.stage, key.digest, "", 0});  // before it is there: a kill may come between
  return write_file_atomically(path, bytes);
}

Store::Work::Work(std::shared_ptr<Journal> journal, const Key& key, std::string item)
    : journal_(std::move(journal)), key_(key), item_(std::move(item)), start_(std::chrono::steady_clock::now()) {
  if (journal_) journal_->write({0, "began", key_.stage, key_.digest, item_, 0});
}

void Store::Work::made() { end("made", item_); }

void Store::Work::failed(const Error& error) { end("failed", error.text()); }

void Store::Work::end(const std::string& event, const std::string& item) {
  if (!journal_) return;
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  journal_->write({0, event, key_.stage, key_.digest, item, seconds});
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
