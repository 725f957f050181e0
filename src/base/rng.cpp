#include "base/rng.h"

#include <cmath>
#include <numbers>

#include "base/digest.h"

namespace isthmus {

double Rng::normal() {
  const double u = 1.0 - uniform();  // in (0, 1]
  const double v = uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

std::uint64_t seed_of(std::uint64_t seed, std::string_view item) {
  Digest digest;
  digest.add(seed);
  digest.add(item);
  return digest.value64();
}

}  // namespace isthmus
