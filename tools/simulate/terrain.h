// Ground as a sum of waves: smooth, seeded, with a height everywhere.
#pragma once

#include <vector>

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

class Terrain {
 public:
  /// `relief_m`: amplitude of the longest waves (of wavelength_m); each octave halves both. slope: rise per metre.
  Terrain(double slope, double relief_m, double wavelength_m, int octaves, Rng& rng);
  [[nodiscard]] double height_m(double x, double y) const;
  [[nodiscard]] Vector3d at(double x, double y) const { return {x, y, height_m(x, y)}; }

 private:
  struct Wave {
    Vector2d wave_vector;
    double amplitude_m, phase;
  };
  Vector2d gradient_;
  std::vector<Wave> waves_;
};

/// A grid over [x0, x1] x [y0, y1], each vertex raised by the terrain, plus `roughness_m` of seeded noise per vertex.
void add_ground(Mesh& mesh, const Terrain& terrain, const Vector2d& low, const Vector2d& high, double step_m,
                double roughness_m, Material material, Rng& rng);

}  // namespace isthmus::sim
