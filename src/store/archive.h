// Structs with field lists (base/fields.h) to bytes and back.
//
// Little-endian, no padding: numbers as in memory, bool as one byte, enums as their number; a vector or string as its
// length (u64) and its items; an optional as one byte and the value; a pair as its two members; Eigen matrices column
// by column; an Isometry3d as its 3x4 part. There are no tags: both sides walk the same list, and the artifact around
// the bytes (store.h) carries version and checksum.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/fields.h"

namespace isthmus::store {

static_assert(std::endian::native == std::endian::little, "artifacts are little-endian bytes");

namespace detail {
template <class T>
struct IsEigen : std::false_type {};
template <class S, int R, int C, int O, int MR, int MC>
struct IsEigen<Eigen::Matrix<S, R, C, O, MR, MC>> : std::bool_constant<(R > 0 && C > 0)> {};

/// Types whose bytes in memory are their bytes on disk, so that vectors of them go in one copy.
template <class T>
concept Plain = (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) || std::is_enum_v<T> || IsEigen<T>::value;
}  // namespace detail

class ArchiveWriter {
 public:
  template <class T>
  void operator()(const T& value) {
    if constexpr (HasFields<T>) {
      const_cast<T&>(value).fields([this](auto& member) { (*this)(std::as_const(member)); });  // fields() only lists
    } else {
      write(value);
    }
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;

  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void write(bool value) { bytes_.push_back(value ? '\1' : '\0'); }
  template <detail::Plain T>
  void write(const T& value) {
    append(&value, sizeof value);
  }
  void write(const Eigen::Isometry3d& value) { write(Eigen::Matrix<double, 3, 4>(value.matrix().topRows<3>())); }
  void write(const std::string& value) {
    write(static_cast<std::uint64_t>(value.size()));
    append(value.data(), value.size());
  }
  template <class T>
  void write(const std::vector<T>& value) {
    write(static_cast<std::uint64_t>(value.size()));
    if constexpr (detail::Plain<T>) {
      append(value.data(), value.size() * sizeof(T));
    } else {
      for (const T& item : value) (*this)(item);
    }
  }
  template <class T, std::size_t N>
  void write(const std::array<T, N>& value) {
    for (const T& item : value) (*this)(item);
  }
  template <class T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value) (*this)(*value);
  }
  template <class A, class B>
  void write(const std::pair<A, B>& value) {
    (*this)(value.first);
    (*this)(value.second);
  }
};

/// Reads what ArchiveWriter wrote. Never reads outside the bytes nor reserves more than they could hold; after the
/// first wrong length everything else stays as it was and complete() is false.
class ArchiveReader {
 public:
  explicit ArchiveReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  void operator()(T& value) {
    if constexpr (HasFields<T>) {
      value.fields([this](auto& member) { (*this)(member); });
    } else {
      read(value);
    }
  }
  /// Whether every read found its bytes and none are left over.
  [[nodiscard]] bool complete() const { return ok_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool ok_ = true;

  bool take(void* out, std::size_t size) {
    if (!ok_ || size > rest_.size()) return ok_ = false;
    if (size > 0) std::memcpy(out, rest_.data(), size);
    rest_.remove_prefix(size);
    return true;
  }
  /// A length; an item takes at least one byte, so more items than bytes left is damage.
  std::size_t take_length() {
    std::uint64_t length = 0;
    if (!take(&length, sizeof length)) return 0;
    if (length > rest_.size()) ok_ = false;
    return ok_ ? static_cast<std::size_t>(length) : 0;
  }
  void read(bool& value) {
    char byte = 0;
    if (take(&byte, 1)) value = byte != 0;
  }
  template <detail::Plain T>
  void read(T& value) {
    take(&value, sizeof value);
  }
  void read(Eigen::Isometry3d& value) {
    Eigen::Matrix<double, 3, 4> rows;
    if (!take(rows.data(), sizeof rows)) return;
    value.setIdentity();
    value.matrix().topRows<3>() = rows;
  }
  void read(std::string& value) {
    value.resize(take_length());
    take(value.data(), value.size());
  }
  template <class T>
  void read(std::vector<T>& value) {
    const std::size_t length = take_length();
    if constexpr (detail::Plain<T>) {
      if (length > rest_.size() / sizeof(T)) ok_ = false;
      value.resize(ok_ ? length : 0);
      take(value.data(), value.size() * sizeof(T));
    } else {
      value.clear();
      for (std::size_t i = 0; ok_ && i < length; ++i) (*this)(value.emplace_back());
    }
  }
  template <class T, std::size_t N>
  void read(std::array<T, N>& value) {
    for (T& item : value) (*this)(item);
  }
  template <class T>
  void read(std::optional<T>& value) {
    bool present = false;
    read(present);
    value.reset();
    if (present && ok_) (*this)(value.emplace());
  }
  template <class A, class B>
  void read(std::pair<A, B>& value) {
    (*this)(value.first);
    (*this)(value.second);
  }
};

template <class T>
std::string to_bytes(const T& value) {
  ArchiveWriter writer;
  writer(value);
  return writer.bytes();
}

}  // namespace isthmus::store
