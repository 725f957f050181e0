// Content-addressed artifacts on disk: what a stage made of its inputs, found again by what went into it.
//
// FOLDER/<stage>/<first 2 digits>/<32 hex digits>.artifact, each file
//   magic    8 bytes  "isthmusA"
//   format   u32      of this envelope
//   key      u64 length + text: the key it was stored under, so that a renamed file is noticed
//   payload  u64 length + bytes (archive.h)
//   checksum 16 bytes XXH3 (128 bits) of everything before
// Files appear by rename, so any number of programs may share a folder; two that make the same artifact write the same
// bytes, and the later one wins.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "store/archive.h"
#include "store/journal.h"
#include "store/store_lock.h"

namespace isthmus::store {

/// What an artifact was made by and from.
struct Key {
  std::string stage;   ///< a word: "sampled", "features", "pair"
  std::string digest;  ///< 32 hex digits over code version, settings and inputs; see make_key()

  template <class F>
  void fields(F&& f) {
    f(stage), f(digest);
  }
};

/// The key of what `stage` in its `version` makes of inputs (digests of files, settings or other keys, in order).
Key make_key(std::string_view stage, std::string_view version, std::span<const std::string> inputs);

class Store {
 public:
  /// Told about each damaged artifact that was found (and will be made anew), and about the first one that could not be
  /// kept. Called from any thread.
  using OnTrouble = std::function<void(const Error&)>;

  /// Creates the folder if need be; fails when it cannot be written or is being cleaned (collect.h).
  static Result<Store> open(const std::filesystem::path& folder, OnTrouble on_trouble);

  /// A store that keeps nothing and finds nothing.
  static Store none() { return {{}, {}, nullptr}; }

  /// The artifact, or nothing when there is none or it is damaged (which is reported through OnTrouble).
  template <class T>
  std::optional<T> load(const Key& key) const {
    const std::optional<std::string> payload = load_payload(key);
    if (!payload) return std::nullopt;
    std::optional<T> value(std::in_place);
    ArchiveReader reader(*payload);
    reader(*value);
    if (reader.complete()) return value;
    report_damage(key, "its content does not have the expected form");
    return std::nullopt;
  }

  template <class T>
  Result<void> save(const Key& key, const T& value) const {
    return save_payload(key, to_bytes(value));
  }

  /// save(), where a failure (a full disk) only costs time later: it is reported once through OnTrouble.
  template <class T>
  void keep(const Key& key, const T& value) const {
    if (const Result<void> saved = save(key, value); !saved) report_unkept(saved.error());
  }

  /// Whether there is an artifact, damaged or not.
  [[nodiscard]] bool contains(const Key& key) const;

  /// Notes in the journal that an artifact is needed though it is not loaded now.
  void need(const Key& key) const;

  /// Remembers that the runs of an output use the store: what they need is not collected.
  void add_user(const std::filesystem::path& output) const;

  /// From now on work() is noted there.
  void set_journal(std::shared_ptr<Journal> journal) { journal_ = std::move(journal); }

  /// Notes that a product was begun and, with made() or failed(), how it ended. `item` is what a person calls it.
  class Work {
   public:
    Work(std::shared_ptr<Journal> journal, const Key& key, std::string item);
    /// The product was made and, unless the disk is full, kept.
    void made();
    void failed(const Error& error);

   private:
    void end(const std::string& event, const std::string& item);
    std::shared_ptr<Journal> journal_;
    Key key_;
    std::string item_;
    std::chrono::steady_clock::time_point start_;
  };
  [[nodiscard]] Work work(const Key& key, std::string item) const { return {journal_, key, std::move(item)}; }

  [[nodiscard]] std::filesystem::path path_of(const Key& key) const;
  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  Store(std::filesystem::path folder, OnTrouble on_trouble, std::shared_ptr<const StoreLock> lock)
      : folder_(std::move(folder)), on_trouble_(std::move(on_trouble)), lock_(std::move(lock)) {}
  [[nodiscard]] std::optional<std::string> load_payload(const Key& key) const;
  [[nodiscard]] Result<void> save_payload(const Key& key, const std::string& payload) const;
  void report_damage(const Key& key, const std::string& reason) const;
  void report_unkept(const Error& error) const;

  std::filesystem::path folder_;
  OnTrouble on_trouble_;
  std::shared_ptr<const StoreLock> lock_;  // shared with every other process that computes
  std::shared_ptr<Journal> journal_;
  std::shared_ptr<std::once_flag> unkept_reported_ = std::make_shared<std::once_flag>();
};

}  // namespace isthmus::store
