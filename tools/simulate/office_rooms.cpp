#include "simulate/office_rooms.h"

#include <algorithm>
#include <numbers>
#include <optional>

#include "simulate/objects.h"
#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// Reserves a footprint, or says that something is in the way.
bool reserve(RoomSpace& room, const Rect& wanted) {
  constexpr double kEps = 1e-6;
  const Rect& in = room.inside;
  if (wanted.x0 < in.x0 - kEps || wanted.x1 > in.x1 + kEps || wanted.y0 < in.y0 - kEps || wanted.y1 > in.y1 + kEps)
    return false;
  if (std::ranges::any_of(room.keep_out, [&](const Rect& r) { return r.touches(wanted); })) return false;
  room.keep_out.push_back(wanted);
  return true;
}

/// A free place for a thing of width x depth with its back to a random wall: its frame, or nothing after some tries.
std::optional<Transform> place_at_wall(RoomSpace& room, double width, double depth, Rng& rng) {
  constexpr int kTries = 12;
  const Rect& in = room.inside;
  for (int k = 0; k < kTries; ++k) {
    const auto wall = rng.below(4);
    const double share = rng.uniform(), half = width / 2;
    const double x = in.x0 + half + share * std::max(0.0, in.x1 - in.x0 - width);
    const double y = in.y0 + half + share * std::max(0.0, in.y1 - in.y0 - width);
    if (wall == 0 && reserve(room, {x - half, x + half, in.y0, in.y0 + depth})) return upright({x, in.y0, 0}, 0);
    if (wall == 1 && reserve(room, {x - half, x + half, in.y1 - depth, in.y1})) return upright({x, in.y1, 0}, kPi);
    if (wall == 2 && reserve(room, {in.x0, in.x0 + depth, y - half, y + half})) return upright({in.x0, y, 0}, -kPi / 2);
    if (wall == 3 && reserve(room, {in.x1 - depth, in.x1, y - half, y + half})) return upright({in.x1, y, 0}, kPi / 2);
  }
  return std::nullopt;
}

std::optional<Transform> place_inside(RoomSpace& room, double width, double depth, Rng& rng) {
  constexpr int kTries = 8;
  const Rect& in = room.inside;
  for (int k = 0; k < kTries; ++k) {
    const double x = rng.uniform(in.x0 + width / 2, std::max(in.x0 + width / 2, in.x1 - width / 2));
    const double y = rng.uniform(in.y0 + depth / 2, std::max(in.y0 + depth / 2, in.y1 - depth / 2));
    if (reserve(room, {x - width / 2, x + width / 2, y - depth / 2, y + depth / 2})) return upright({x, y, 0}, 0);
  }
  return std::nullopt;
}

void add_wall_things(Mesh& mesh, RoomSpace& room, Rng& rng) {
  const auto count = 1 + rng.below(4);
  for (std::uint64_t k = 0; k < count; ++k) {
    const double width = rng.uniform(0.4, 1.8), z = rng.uniform(1.0, 1.4), height = rng.uniform(0.4, 0.9);
    const double depth = rng.uniform(0.02, 0.06);
    const auto place = place_at_wall(room, width, depth, rng);
    const Material material = chance(rng, 0.3) ? Material::screen : Material::paper;
    if (place) add_box(mesh, *place, {-width / 2, 0, z}, {width / 2, depth, z + height}, material);
  }
}

void add_lamps(Mesh& mesh, const RoomSpace& room, Rng& rng) {
  const double pitch = rng.uniform(1.8, 2.8), drop = chance(rng, 0.5) ? rng.uniform(0.3, 0.6) : 0.06;
  const double length = rng.uniform(0.6, 1.3), width = rng.uniform(0.12, 0.6);
  const Rect& in = room.inside;
  for (double x = in.x0 + pitch / 2; x < in.x1 - 0.3; x += pitch) {
    for (double y = in.y0 + std::min(pitch, in.y1 - in.y0) / 2; y < in.y1 - 0.3; y += pitch) {
      const double z = room.height_m - drop;
      const Transform f = upright({x, y, z}, 0);
      add_box(mesh, f, {-width / 2, -length / 2, 0}, {width / 2, length / 2, 0.06}, Material::paint_white);
      if (drop < 0.1) continue;
      for (const double s : {-0.4, 0.4}) {
        add_box(mesh, f, {-0.01, s * length - 0.01, 0.06}, {0.01, s * length + 0.01, drop}, Material::metal);
      }
    }
  }
}

void furnish_office(Mesh& mesh, RoomSpace& room, double area, Rng& rng) {
  const int desks = std::max(1, static_cast<int>(area / rng.uniform(7, 12)));
  for (int k = 0; k < desks; ++k) {
    if (const auto place = place_at_wall(room, 1.65, 1.5, rng)) add_desk(mesh, *place, rng);
  }
  for (int k = 0; k < 2; ++k) {
    const double width = rng.uniform(0.8, 1.6);
    if (const auto place = place_at_wall(room, width, 0.37, rng))
      add_shelf(mesh, *place, width, rng.uniform(1.1, 2.2), rng);
  }
  if (const auto place = place_at_wall(room, 0.95, 0.5, rng))
    add_cabinet(mesh, *place, 0.9, rng.uniform(0.8, 2.0), rng);
}

void furnish_meeting(Mesh& mesh, RoomSpace& room, Rng& rng) {
  const double w = room.inside.x1 - room.inside.x0, d = room.inside.y1 - room.inside.y0;
  const double length = std::clamp(0.55 * w, 1.4, 4.5), width = rng.uniform(0.9, 1.3);
  if (d > width + 1.8) {
    if (const auto place = place_inside(room, length + 0.4, width + 1.3, rng))
      add_table(mesh, *place, length, width, rng);
  }
  if (const auto place = place_at_wall(room, 1.25, 0.5, rng))
    add_cabinet(mesh, *place, 1.2, rng.uniform(0.8, 1.1), rng);
}

void furnish_storage(Mesh& mesh, RoomSpace& room, Rng& rng) {
  for (int k = 0; k < 7; ++k) {
    const double width = rng.uniform(0.9, 2.0);
    if (const auto place = place_at_wall(room, width, 0.37, rng))
      add_shelf(mesh, *place, width, rng.uniform(1.8, 2.4), rng);
  }
  for (int k = 0; k < 3; ++k) {
    if (const auto place = place_inside(room, 0.7, 0.7, rng)) {
      add_box(mesh, *place, {-0.3, -0.25, 0}, {0.3, 0.25, rng.uniform(0.3, 1.0)}, Material::paper);
    }
  }
}

void furnish_kitchen(Mesh& mesh, RoomSpace& room, Rng& rng) {
  const double width = rng.uniform(1.6, 2.6);
  if (const auto place = place_at_wall(room, width + 1.4, 0.65, rng)) add_counter(mesh, *place, width, rng);
  for (int k = 0; k < 2; ++k) {
    if (const auto place = place_inside(room, 1.7, 2.1, rng)) add_table(mesh, *place, 1.2, 0.8, rng);
  }
}

void furnish_lounge(Mesh& mesh, RoomSpace& room, Rng& rng) {
  for (int k = 0; k < 3; ++k) {
    const double width = rng.uniform(1.0, 2.2);
    if (const auto place = place_at_wall(room, width, 0.95, rng)) add_sofa(mesh, *place, width, rng);
  }
  if (const auto place = place_inside(room, 1.1, 0.8, rng)) {
    add_box(mesh, *place, {-0.5, -0.35, 0.38}, {0.5, 0.35, 0.42}, Material::wood);
    add_box(mesh, *place, {-0.1, -0.1, 0}, {0.1, 0.1, 0.38}, Material::dark_metal);
  }
}

void furnish_corridor(Mesh& mesh, RoomSpace& room, Rng& rng) {
  const int things = static_cast<int>((room.inside.x1 - room.inside.x0) / 4);
  for (int k = 0; k < things; ++k) {
    const double kind = rng.uniform(), width = rng.uniform(0.6, 1.4);
    if (kind < 0.4) {
      if (const auto place = place_at_wall(room, width, 0.46, rng))
        add_cabinet(mesh, *place, width, rng.uniform(0.7, 1.9), rng);
    } else if (kind < 0.6) {
      if (const auto place = place_at_wall(room, width, 0.37, rng))
        add_shelf(mesh, *place, width, rng.uniform(0.9, 1.8), rng);
    } else if (const auto place = place_at_wall(room, 0.25, 0.2, rng)) {  // an extinguisher on its hook
      add_frustum(mesh, *place * Vector3d(0, 0.11, 0.6), *place * Vector3d(0, 0.11, 1.1), 0.08, 0.07, 10,
                  Material::paint_red);
    }
  }
}

}  // namespace

void furnish(Mesh& mesh, RoomSpace& room, Rng& rng) {
  const Rect& in = room.inside;
  const double area = (in.x1 - in.x0) * (in.y1 - in.y0);
  if (room.is_corridor) {
    furnish_corridor(mesh, room, rng);
  } else {
    const double kind = rng.uniform();
    if (kind < 0.5) {
      furnish_office(mesh, room, area, rng);
    } else if (kind < 0.68) {
      furnish_meeting(mesh, room, rng);
    } else if (kind < 0.8) {
      furnish_storage(mesh, room, rng);
    } else if (kind < 0.9) {
      furnish_kitchen(mesh, room, rng);
    } else {
      furnish_lounge(mesh, room, rng);
    }
    if (chance(rng, 0.5)) {
      if (const auto place = place_inside(room, 0.65, 0.65, rng)) add_pot_plant(mesh, *place, rng);
    }
  }
  add_wall_things(mesh, room, rng);
  add_lamps(mesh, room, rng);
}

}  // namespace isthmus::sim
