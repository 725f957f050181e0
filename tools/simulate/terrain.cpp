#include "simulate/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus::sim {

Terrain::Terrain(double slope, double relief_m, double wavelength_m, int octaves, Rng& rng) {
  constexpr int kWavesPerOctave = 3;
  const auto unit = [&rng] {
    const double angle = rng.uniform(0, 2 * std::numbers::pi);
    return Vector2d(std::cos(angle), std::sin(angle));
  };
  gradient_ = slope * unit();
  for (int octave = 0; octave < octaves; ++octave) {
    for (int k = 0; k < kWavesPerOctave; ++k) {
      const double scale = std::ldexp(1.0, -octave), wavelength = scale * wavelength_m * rng.uniform(0.8, 1.25);
      waves_.push_back({2 * std::numbers::pi / wavelength * unit(),
                        scale * relief_m / kWavesPerOctave * rng.uniform(0.7, 1.3),
                        rng.uniform(0, 2 * std::numbers::pi)});
    }
  }
}

double Terrain::height_m(double x, double y) const {
  const Vector2d p(x, y);
  double z = gradient_.dot(p);
  for (const Wave& wave : waves_) z += wave.amplitude_m * std::sin(wave.wave_vector.dot(p) + wave.phase);
  return z;
}

void add_ground(Mesh& mesh, const Terrain& terrain, const Vector2d& low, const Vector2d& high, double step_m,
                double roughness_m, Material material, Rng& rng) {
  const int columns = std::max(1, static_cast<int>(std::ceil((high.x() - low.x()) / step_m)));
  const int rows = std::max(1, static_cast<int>(std::ceil((high.y() - low.y()) / step_m)));
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  const Vector2d step((high.x() - low.x()) / columns, (high.y() - low.y()) / rows);
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      const double x = low.x() + c * step.x(), y = low.y() + r * step.y();
      mesh.vertices.push_back(Vector3d(x, y, terrain.height_m(x, y) + roughness_m * rng.normal()).cast<float>());
    }
  }
  const auto index = [&](int r, int c) { return first + static_cast<std::uint32_t>(r * (columns + 1) + c); };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      mesh.triangles.push_back({index(r, c), index(r, c + 1), index(r + 1, c + 1)});
      mesh.triangles.push_back({index(r, c), index(r + 1, c + 1), index(r + 1, c)});
      mesh.materials.insert(mesh.materials.end(), 2, material);
    }
  }
}

}  // namespace isthmus::sim
