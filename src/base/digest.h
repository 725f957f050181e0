// Content digests (xxHash XXH3, 128 bits) for artifact keys, checksums and seeds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace isthmus {

/// Accumulates bytes; every add() of a string also adds its length, so that "ab"+"c" differs from "a"+"bc".
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(Digest&&) noexcept;
  Digest& operator=(Digest&&) noexcept;

  Digest& add_bytes(const void* data, std::size_t size);
  Digest& add(std::string_view text);
  template <class T>
  requires std::is_arithmetic_v<T> Digest& add(T value) { return add_bytes(&value, sizeof value); }
  [[nodiscard]] std::uint64_t value64() const;  ///< the low 64 bits
  [[nodiscard]] std::string hex() const;        ///< 32 hexadecimal digits

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace isthmus
