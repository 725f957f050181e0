#include "store/collect.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "base/atomic_file.h"
#include "base/disk_space.h"
#include "store/store.h"
#include "store/store_lock.h"

namespace isthmus::store {
namespace {

namespace fs = std::filesystem;

struct Artifact {
  fs::path path;
  std::string key;  ///< empty for the half of a file
  std::uint64_t bytes = 0;
  fs::file_time_type time;
};

/// FOLDER/<stage>/<2 digits>/<digest>.artifact, and "<that>.tmp-<process>-<number>" (base/atomic_file.h).
std::vector<Artifact> artifacts_in(const fs::path& folder) {
  std::vector<Artifact> found;
  std::error_code error;
  fs::recursive_directory_iterator entry(folder, error), end;
  for (; !error && entry != end; entry.increment(error)) {
    if (entry.depth() != 2 || !entry->is_regular_file(error)) continue;
    const std::string name = entry->path().filename().string();
    Artifact artifact{entry->path(), "", entry->file_size(error), entry->last_write_time(error)};
    if (entry->path().extension() == ".artifact") {
      const fs::path stage = entry->path().parent_path().parent_path().filename();
      artifact.key = (stage / entry->path().stem()).string();
    } else if (name.find(".artifact.tmp-") == std::string::npos) {
      continue;
    }
    if (!error) found.push_back(std::move(artifact));
    error.clear();
  }
  return found;
}

}  // namespace

Result<Collected> collect(const fs::path& folder, const std::set<std::string>& needed, const CollectLimits& limits,
                          bool dry_run) {
  const Result<StoreLock> lock = StoreLock::take(folder, StoreLock::Kind::exclusive);
  if (!lock) return tl::unexpected(lock.error());
  std::vector<Artifact> spare;
  Collected out;
  for (Artifact& artifact : artifacts_in(folder)) {
    if (needed.contains(artifact.key)) {
      ++out.num_needed;
      out.bytes_left += artifact.bytes;
    } else {
      spare.push_back(std::move(artifact));
    }
  }
  std::ranges::sort(spare, [](const Artifact& a, const Artifact& b) {
    return std::pair(b.time, a.path) < std::pair(a.time, b.path);  // youngest first
  });
  const fs::file_time_type now = fs::file_time_type::clock::now();
  const bool any_limit = limits.keep_younger_than || limits.max_bytes;
  for (const Artifact& artifact : spare) {
    const bool young = !limits.keep_younger_than || now - artifact.time < *limits.keep_younger_than;
    const bool fits = !limits.max_bytes || out.bytes_left + artifact.bytes <= *limits.max_bytes;
    if (any_limit && young && fits && !artifact.key.empty()) {
      ++out.num_kept;
      out.bytes_left += artifact.bytes;
      continue;
    }
    std::error_code error;
    if (!dry_run) fs::remove(artifact.path, error);
    if (error) return tl::unexpected(write_error("cannot be removed", error.value(), artifact.path));
    ++out.num_removed;
    out.bytes_removed += artifact.bytes;
  }
  return out;
}

std::set<fs::path> users_of(const fs::path& folder) {
  std::set<fs::path> users;
  std::error_code error;
  for (fs::directory_iterator entry(folder / "users", error), end; !error && entry != end; entry.increment(error)) {
    const Result<std::string> text = read_file(entry->path());
    if (!text) continue;
    const fs::path user = text->substr(0, text->find('\n'));
    std::error_code missing;
    if (fs::is_directory(user, missing)) users.insert(user);
  }
  return users;
}

}  // namespace isthmus::store
