// Seeded random numbers that belong to items (stage, scan, pair), never to threads.
#pragma once

#include <cstdint>
#include <string_view>

namespace isthmus {

/// SplitMix64 (Steele, Lea, Flood 2014): small, fast, the same sequence on every platform.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15ULL);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, n); n > 0. The bias of the multiply-shift is below n / 2^64.
  std::uint64_t below(std::uint64_t n) {
    return static_cast<std::uint64_t>((static_cast<unsigned __int128>(next()) * n) >> 64);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Box and Muller 1958).
  double normal();

 private:
  std::uint64_t state_;
};

/// A seed for an item: mixes a stage's seed with the item's name, so that order and threads do not matter.
std::uint64_t seed_of(std::uint64_t seed, std::string_view item);

}  // namespace isthmus
