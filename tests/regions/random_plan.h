// Ground plans of no place in particular.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>

#include "base/rng.h"
#include "regions/ground_plan.h"

namespace isthmus::testing {

inline GroundPlan with_radius(GroundPlan plan) {
  plan.radius_m = 0;
  for (const Column& c : plan.columns) plan.radius_m = std::max(plan.radius_m, c.p.norm());
  return plan;
}

/// Columns spread over a square of twice `half_m`; two of three face one way.
inline GroundPlan random_plan(std::size_t columns, double half_m, std::uint64_t seed) {
  Rng rng(seed);
  GroundPlan plan;
  plan.cell_m = 0.6f;
  for (std::size_t k = 0; k < columns; ++k) {
    Column c;
    c.p = Eigen::Vector2d(rng.uniform(-half_m, half_m), rng.uniform(-half_m, half_m)).cast<float>();
    c.heading = wrapped(static_cast<float>(rng.uniform(-3, 3)));
    c.faces = k % 3 != 0;
    c.bottom = static_cast<float>(rng.uniform(-2, 2));
    c.top = c.bottom + static_cast<float>(rng.uniform(1, 8));
    plan.columns.push_back(c);
  }
  return with_radius(std::move(plan));
}

inline GroundPlan moved(GroundPlan plan, float yaw, const Eigen::Vector2f& shift, float up = 0) {
  for (Column& c : plan.columns) {
    c.p = Eigen::Rotation2Df(yaw) * c.p + shift;
    c.heading = wrapped(c.heading + yaw);
    c.bottom += up, c.top += up;
  }
  return with_radius(std::move(plan));
}

/// What a station at `place` sees, about it.
inline GroundPlan seen_within(GroundPlan plan, const Eigen::Vector2f& place, float radius_m) {
  std::erase_if(plan.columns, [&](const Column& c) { return (c.p - place).norm() > radius_m; });
  return moved(std::move(plan), 0, -place);
}

}  // namespace isthmus::testing
