// Trees, bushes, stumps, rocks. Roots at the frame's origin.
#pragma once

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

/// A town tree: clear trunk, some boughs, a crown of single leaves (tufts) filling an ellipsoid.
void add_town_tree(Mesh& mesh, const Vector3d& root, double height_m, Rng& rng);
/// A forest tree: leaning, tapering trunk, dead twigs below, thin crown above.
void add_forest_tree(Mesh& mesh, const Vector3d& root, double height_m, Rng& rng);
void add_bush(Mesh& mesh, const Vector3d& root, double radius_m, Rng& rng);
void add_stump(Mesh& mesh, const Vector3d& root, Rng& rng);
void add_log(Mesh& mesh, const Vector3d& from, const Vector3d& to, Rng& rng);
void add_rock(Mesh& mesh, const Vector3d& at, double size_m, Rng& rng);

}  // namespace isthmus::sim
