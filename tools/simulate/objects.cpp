#include "simulate/objects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

Vector3d at(const Transform& frame, double x, double y, double z) { return frame * Vector3d(x, y, z); }

Transform shifted(const Transform& frame, double x, double y, double z, double yaw_rad = 0) {
  return frame * upright({x, y, z}, yaw_rad);
}

void add_legs(Mesh& mesh, const Transform& frame, double half_x, double y0, double y1, double height,
              Material material) {
  constexpr double kHalf = 0.025;
  for (const double x : {-half_x, half_x}) {
    for (const double y : {y0, y1})
      add_box(mesh, frame, {x - kHalf, y - kHalf, 0}, {x + kHalf, y + kHalf, height}, material);
  }
}

/// Books, folders and boxes on a board from x0 to x1.
void add_things_on_board(Mesh& mesh, const Transform& frame, double x0, double x1, double z, double room_above,
                         Rng& rng) {
  double x = x0;
  while (x < x1 - 0.05) {
    const double width = std::min(rng.uniform(0.05, 0.35), x1 - x);
    if (chance(rng, 0.75)) {
      const Material material = chance(rng, 0.5) ? Material::paper : Material::cloth_dark;
      add_box(mesh, frame, {x, 0.03, z},
              {x + 0.95 * width, rng.uniform(0.18, 0.31), z + room_above * rng.uniform(0.5, 0.95)}, material);
    }
    x += width;
  }
}

}  // namespace

void add_person(Mesh& mesh, const Transform& f, Rng& rng) {
  const double h = rng.uniform(1.55, 1.92) / 1.75, stride = rng.uniform(0.0, 0.35);
  const Material coat = chance(rng, 0.5) ? Material::cloth_dark : Material::cloth_light;
  add_frustum(mesh, at(f, stride, 0.1, 0), at(f, 0, 0.09, 0.85 * h), 0.07, 0.1, 8, Material::cloth_dark);
  add_frustum(mesh, at(f, -stride, -0.1, 0), at(f, 0, -0.09, 0.85 * h), 0.07, 0.1, 8, Material::cloth_dark);
  add_ellipsoid(mesh, shifted(f, 0, 0, 1.13 * h), {0.15, 0.22, 0.34 * h}, 6, 10, coat);
  for (const double side : {-1.0, 1.0}) {
    const Vector3d hand = at(f, -side * stride, side * 0.3, 0.8 * h);
    add_frustum(mesh, at(f, 0, side * 0.23, 1.38 * h), hand, 0.06, 0.045, 6, coat);
  }
  add_ellipsoid(mesh, shifted(f, 0.01, 0, 1.62 * h), {0.1, 0.085, 0.13 * h}, 6, 8, Material::skin);
}

void add_car(Mesh& mesh, const Transform& f, Rng& rng) {
  const double l = rng.uniform(1.9, 2.4), w = rng.uniform(0.84, 0.95), roof = rng.uniform(1.4, 1.85);
  constexpr Material kPaints[] = {Material::paint_white, Material::paint_red, Material::paint_black, Material::metal};
  const Material paint = kPaints[rng.below(4)];
  const double sill = 0.25, belt = rng.uniform(0.85, 1.0), nose = l - rng.uniform(0.1, 1.1),
               tail = -l + rng.uniform(0.05, 0.6);
  add_box(mesh, f, {-l, -w, sill}, {l, w, belt}, paint);
  // Cabin: a truncated pyramid, glazed all round under the roof.
  const double in = 0.12, front = nose - rng.uniform(0.5, 0.8), back = tail + rng.uniform(0.1, 0.4);
  const Vector3d foot[4] = {at(f, tail, -w, belt), at(f, nose, -w, belt), at(f, nose, w, belt), at(f, tail, w, belt)};
  const Vector3d top[4] = {at(f, back, -w + in, roof), at(f, front, -w + in, roof), at(f, front, w - in, roof),
                           at(f, back, w - in, roof)};
  for (int k = 0; k < 4; ++k) add_quad(mesh, foot[k], foot[(k + 1) % 4], top[(k + 1) % 4], top[k], Material::screen);
  add_quad(mesh, top[0], top[1], top[2], top[3], paint);
  for (const double x : {-0.62 * l, 0.62 * l}) {
    for (const double side : {-1.0, 1.0}) {
      add_frustum(mesh, at(f, x, side * (w - 0.2), 0.31), at(f, x, side * (w + 0.01), 0.31), 0.31, 0.31, 12,
                  Material::rubber);
    }
  }
}

void add_chair(Mesh& mesh, const Transform& f, Rng& rng) {
  const Material cloth = chance(rng, 0.6) ? Material::cloth_dark : Material::wood;
  const double seat = rng.uniform(0.43, 0.5);
  add_box(mesh, f, {-0.23, -0.23, seat}, {0.23, 0.23, seat + 0.06}, cloth);
  add_box(mesh, f, {-0.22, -0.26, seat + 0.1}, {0.22, -0.21, seat + rng.uniform(0.4, 0.6)}, cloth);
  if (chance(rng, 0.6)) {
    add_frustum(mesh, at(f, 0, 0, 0.08), at(f, 0, 0, seat), 0.03, 0.03, 8, Material::dark_metal);
    for (int k = 0; k < 5; ++k) {
      const double a = 2 * std::numbers::pi * k / 5;
      add_frustum(mesh, at(f, 0, 0, 0.1), at(f, 0.28 * std::cos(a), 0.28 * std::sin(a), 0.05), 0.025, 0.03, 6,
                  Material::dark_metal);
    }
  } else {
    add_legs(mesh, f, 0.2, -0.2, 0.2, seat, Material::metal);
  }
}

void add_desk(Mesh& mesh, const Transform& f, Rng& rng) {
  const double top = rng.uniform(0.7, 0.78);
  add_box(mesh, f, {-0.8, 0, top - 0.03}, {0.8, 0.8, top}, Material::wood);
  add_legs(mesh, f, 0.74, 0.06, 0.74, top - 0.03, Material::metal);
  if (chance(rng, 0.7)) {
    const double x = chance(rng, 0.5) ? -0.7 : 0.28;
    add_box(mesh, f, {x, 0.1, 0.03}, {x + 0.42, 0.7, 0.6}, Material::metal);
  }
  const int screens = 1 + static_cast<int>(rng.below(2));
  for (int k = 0; k < screens; ++k) {
    const Transform s =
        shifted(f, screens == 1 ? rng.uniform(-0.3, 0.3) : -0.32 + 0.64 * k, 0.25, top, rng.uniform(-0.2, 0.2));
    add_box(mesh, s, {-0.12, -0.1, 0}, {0.12, 0.1, 0.015}, Material::dark_metal);
    add_box(mesh, s, {-0.03, -0.02, 0.015}, {0.03, 0.0, 0.3}, Material::dark_metal);
    add_box(mesh, s, {-0.28, 0.0, 0.13}, {0.28, 0.03, 0.47}, Material::screen);
  }
  const auto things = rng.below(4);
  for (std::uint64_t k = 0; k < things; ++k) {
    const Transform s = shifted(f, rng.uniform(-0.65, 0.65), rng.uniform(0.45, 0.65), top, rng.uniform(0, 3));
    add_box(mesh, s, {-0.1, -0.08, 0}, {rng.uniform(0.02, 0.12), 0.08, rng.uniform(0.01, 0.25)}, Material::paper);
  }
  add_chair(mesh,
            shifted(f, rng.uniform(-0.3, 0.3), rng.uniform(0.95, 1.2), 0, std::numbers::pi + rng.uniform(-0.7, 0.7)),
            rng);
}

void add_table(Mesh& mesh, const Transform& f, double length, double width, Rng& rng) {
  const double top = rng.uniform(0.72, 0.76);
  add_box(mesh, f, {-length / 2, -width / 2, top - 0.035}, {length / 2, width / 2, top}, Material::wood);
  add_legs(mesh, f, length / 2 - 0.12, -width / 2 + 0.12, width / 2 - 0.12, top - 0.035, Material::metal);
  const int chairs = std::max(1, static_cast<int>(length / 0.75));
  for (int k = 0; k < chairs; ++k) {
    const double x = length * ((k + 0.5) / chairs - 0.5) + rng.uniform(-0.1, 0.1);
    for (const double side : {-1.0, 1.0}) {
      if (chance(rng, 0.2)) continue;
      const double yaw = (side > 0 ? std::numbers::pi : 0.0) + rng.uniform(-0.5, 0.5);
      add_chair(mesh, shifted(f, x, side * (width / 2 + rng.uniform(0.1, 0.45)), 0, yaw), rng);
    }
  }
}

void add_shelf(Mesh& mesh, const Transform& f, double width, double height, Rng& rng) {
  constexpr double kDepth = 0.35, kBoard = 0.025;
  const Material wood = chance(rng, 0.5) ? Material::wood : Material::metal;
  for (const double x : {-width / 2, width / 2 - kBoard})
    add_box(mesh, f, {x, 0, 0}, {x + kBoard, kDepth, height}, wood);
  add_box(mesh, f, {-width / 2 + kBoard, 0, 0}, {width / 2 - kBoard, 0.01, height}, wood);
  const int boards = std::max(2, static_cast<int>(height / rng.uniform(0.34, 0.42)));
  const double step = (height - kBoard) / boards;
  for (int k = 0; k <= boards; ++k) {
    add_box(mesh, f, {-width / 2 + kBoard, 0.01, k * step}, {width / 2 - kBoard, kDepth, k * step + kBoard}, wood);
    if (k < boards) {
      add_things_on_board(mesh, f, -width / 2 + kBoard, width / 2 - kBoard, k * step + kBoard, step - 2 * kBoard, rng);
    }
  }
}

void add_cabinet(Mesh& mesh, const Transform& f, double width, double height, Rng& rng) {
  const Material material = chance(rng, 0.5) ? Material::metal : Material::dark_wood;
  add_box(mesh, f, {-width / 2, 0, 0.05}, {width / 2, 0.45, height}, material);
  add_box(mesh, f, {-width / 2 + 0.03, 0.02, 0}, {width / 2 - 0.03, 0.42, 0.05}, Material::dark_metal);
  add_box(mesh, f, {0.02, 0.45, 0.45 * height}, {0.04, 0.48, 0.6 * height}, Material::dark_metal);
  if (chance(rng, 0.5)) {
    const Transform s = shifted(f, rng.uniform(-0.2, 0.2) * width, 0.2, height, rng.uniform(0, 3));
    add_box(mesh, s, {-0.17, -0.13, 0}, {0.17, 0.13, rng.uniform(0.1, 0.35)}, Material::paper);
  }
}

void add_sofa(Mesh& mesh, const Transform& f, double width, Rng& rng) {
  const Material cloth = chance(rng, 0.5) ? Material::cloth_dark : Material::cloth_light;
  add_box(mesh, f, {-width / 2, 0.05, 0.08}, {width / 2, 0.9, 0.42}, cloth);
  add_box(mesh, f, {-width / 2, 0.05, 0.42}, {width / 2, 0.28, 0.85}, cloth);
  for (const double x : {-width / 2, width / 2 - 0.18}) add_box(mesh, f, {x, 0.28, 0.42}, {x + 0.18, 0.9, 0.62}, cloth);
}

void add_counter(Mesh& mesh, const Transform& f, double width, Rng& rng) {
  add_box(mesh, f, {-width / 2, 0, 0.1}, {width / 2, 0.58, 0.86}, Material::paint_white);
  add_box(mesh, f, {-width / 2, 0, 0.86}, {width / 2, 0.62, 0.9}, Material::stone);
  add_box(mesh, f, {-width / 2, 0, 1.45}, {width / 2, 0.35, 2.1}, Material::paint_white);
  add_box(mesh, f, {width / 2 + 0.03, 0, 0.02}, {width / 2 + 0.63, 0.62, rng.uniform(1.5, 1.9)}, Material::metal);
  for (int k = 0; k < 3; ++k) {
    const Transform s = shifted(f, rng.uniform(-0.4, 0.4) * width, rng.uniform(0.2, 0.4), 0.9, rng.uniform(0, 3));
    add_box(mesh, s, {-0.1, -0.1, 0}, {0.1, 0.1, rng.uniform(0.15, 0.35)}, Material::metal);
  }
}

void add_pot_plant(Mesh& mesh, const Transform& f, Rng& rng) {
  add_frustum(mesh, at(f, 0, 0, 0), at(f, 0, 0, 0.35), 0.13, 0.18, 12, Material::ceramic);
  const double height = rng.uniform(0.5, 1.3);
  for (int k = 0; k < 40; ++k) {
    const double a = rng.uniform(0, 2 * std::numbers::pi), r = rng.uniform(0.05, 0.45);
    const Vector3d stem = at(f, 0, 0, 0.35 + 0.6 * height * rng.uniform());
    const Vector3d tip = at(f, r * std::cos(a), r * std::sin(a), 0.35 + height * rng.uniform(0.2, 1.0));
    const Vector3d side =
        at(f, r * std::cos(a + 0.35) * 0.6, r * std::sin(a + 0.35) * 0.6, 0.35 + height * rng.uniform(0.2, 0.9));
    add_triangle(mesh, stem, tip, side, Material::leaf);
  }
}

void add_radiator(Mesh& mesh, const Transform& f, double width) {
  const int ribs = std::max(2, static_cast<int>(width / 0.1));
  for (int k = 0; k < ribs; ++k) {
    const double x = -width / 2 + k * width / ribs;
    add_box(mesh, f, {x, 0.03, 0.12}, {x + 0.7 * width / ribs, 0.12, 0.7}, Material::paint_white);
  }
}

void add_lamp_post(Mesh& mesh, const Transform& f, double height, Rng& rng) {
  add_frustum(mesh, at(f, 0, 0, 0), at(f, 0, 0, 0.8), 0.11, 0.1, 10, Material::metal);
  add_frustum(mesh, at(f, 0, 0, 0.8), at(f, 0, 0, height), 0.07, 0.045, 10, Material::metal);
  const double reach = rng.uniform(0.8, 1.6);
  add_frustum(mesh, at(f, 0, 0, height - 0.1), at(f, reach, 0, height + 0.25), 0.04, 0.03, 8, Material::metal);
  add_box(mesh, shifted(f, reach, 0, height + 0.2), {-0.1, -0.15, 0}, {0.6, 0.15, 0.12}, Material::metal);
}

void add_bench(Mesh& mesh, const Transform& f) {
  for (const double x : {-0.6, 0.6}) add_box(mesh, f, {x - 0.05, -0.2, 0}, {x + 0.05, 0.25, 0.42}, Material::concrete);
  for (int k = 0; k < 4; ++k) {
    add_box(mesh, f, {-0.9, -0.2 + 0.12 * k, 0.42}, {0.9, -0.11 + 0.12 * k, 0.46}, Material::wood);
  }
  for (int k = 0; k < 2; ++k) {
    add_box(mesh, f, {-0.9, -0.24, 0.6 + 0.15 * k}, {0.9, -0.2, 0.7 + 0.15 * k}, Material::wood);
  }
}

void add_bin(Mesh& mesh, const Transform& f, Rng& rng) {
  const double height = rng.uniform(0.8, 1.15);
  add_box(mesh, f, {-0.3, -0.35, 0.03}, {0.3, 0.35, height},
          chance(rng, 0.5) ? Material::dark_metal : Material::paint_red);
}

void add_traffic_sign(Mesh& mesh, const Transform& f, Rng& rng) {
  const double height = rng.uniform(2.1, 2.7);
  add_frustum(mesh, at(f, 0, 0, 0), at(f, 0, 0, height), 0.03, 0.03, 8, Material::metal);
  if (chance(rng, 0.5)) {
    add_frustum(mesh, at(f, 0.035, 0, height - 0.35), at(f, 0.05, 0, height - 0.35), 0.3, 0.3, 16,
                Material::paint_white);
  } else {
    add_box(mesh, shifted(f, 0.035, 0, height - 0.6), {0, -0.25, 0}, {0.015, 0.25, 0.55}, Material::paint_white);
  }
}

}  // namespace isthmus::sim
