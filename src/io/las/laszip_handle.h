// LASzip behind a handle that closes itself; for the sources of this folder only.
#pragma once

#include <laszip/laszip_api.h>

#include <string>
#include <utility>

namespace isthmus::io {

class LaszipHandle {
 public:
  LaszipHandle() { laszip_create(&handle_); }
  LaszipHandle(LaszipHandle&& other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
  LaszipHandle& operator=(LaszipHandle&&) = delete;
  ~LaszipHandle() {
    if (handle_ == nullptr) return;
    laszip_close_reader(handle_);  // each fails where nothing of the kind is open
    laszip_close_writer(handle_);
    laszip_destroy(handle_);
  }
  [[nodiscard]] laszip_POINTER get() const { return handle_; }

  [[nodiscard]] std::string error() const {
    laszip_CHAR* text = nullptr;
    if (handle_ == nullptr) return "there is no memory for LASzip";
    return laszip_get_error(handle_, &text) == 0 && text != nullptr ? text : "unknown";
  }

 private:
  laszip_POINTER handle_ = nullptr;
};

}  // namespace isthmus::io
