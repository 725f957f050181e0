#include "store/store_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

namespace isthmus::store {

Result<StoreLock> StoreLock::take(const std::filesystem::path& folder, Kind kind) {
  const int descriptor = ::open((folder / ".lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor < 0) return StoreLock(-1);
  const int how = kind == Kind::shared ? LOCK_SH : LOCK_EX;
  if (::flock(descriptor, how | LOCK_NB) == 0 || errno != EWOULDBLOCK) return StoreLock(descriptor);
  ::close(descriptor);
  if (kind == Kind::shared) return fail("the store is being cleaned", folder.string(), "try again when that is done");
  return fail("a run works in this store", folder.string(), "wait for its end");
}

StoreLock::~StoreLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace isthmus::store
