// An office floor: parallel corridors with rooms on both sides, joined by cross corridors at their ends. Every bay of a
// corridor has one station in the corridor, in front of two open doors, and one in the room behind each.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "simulate/office_rooms.h"
#include "simulate/scene.h"

namespace isthmus::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInner = 0.12;  ///< thickness of inner walls, m
constexpr double kOuter = 0.30;  ///< of outer walls, m
constexpr double kDoorHeight = 2.1;

/// Rooms on one side of a corridor.
struct RoomRow {
  double y0 = 0, y1 = 0;       ///< clear inside
  bool door_at_y1 = false;     ///< which of its long sides faces the corridor
  bool is_outer = false;       ///< the other one has windows
  std::vector<double> door_x;  ///< per bay: the station room's door
  std::vector<RoomSpace> rooms;
};

struct Corridor {
  double y0 = 0, y1 = 0;
  RoomRow south, north;
};

struct Floor {
  Mesh mesh;
  double height = 2.8, corridor_width = 2.2, window_width = 1.5, sill = 0.9;
  std::vector<double> bay_x;  ///< edges of the bays, from 0
  std::vector<Corridor> corridors;
  bool has_cross = false;
  [[nodiscard]] double length() const { return bay_x.back(); }
  [[nodiscard]] double west() const { return has_cross ? -kInner - corridor_width : 0.0; }
  [[nodiscard]] double east() const { return length() + (has_cross ? kInner + corridor_width : 0.0); }
};

Transform wall_along_x(double x, double y) { return upright({x, y, 0}, 0); }
/// Along +y from (x, y), thick towards +x.
Transform wall_along_y(double x, double y, double thickness) { return upright({x + thickness, y, 0}, kPi / 2); }

/// An open or closed leaf in a doorway of a wall along x, on the wall's face at `y`, swinging towards `into` (+1: +y).
void add_door_leaf(Mesh& mesh, double x0, double x1, double y, double into, bool is_open, Rng& rng) {
  const bool hinge_left = chance(rng, 0.5);
  const double open = is_open ? rng.uniform(1.2, 2.2) : 0.0;
  const double toward = hinge_left ? 0.0 : kPi, turn = (hinge_left ? 1.0 : -1.0) * into;
  const Transform f = upright({hinge_left ? x0 : x1, y, 0}, toward + turn * open);
  const double width = x1 - x0 - 0.01;
  add_box(mesh, f, {0, -0.02, 0.01}, {width, 0.02, kDoorHeight - 0.02}, Material::wood);
  add_box(mesh, f, {width - 0.1, -0.07, 1.0}, {width - 0.05, 0.07, 1.03}, Material::metal);
}

/// Glass in a frame, in an opening of a wall whose frame is `wall`, in the middle of its thickness.
void add_window(Mesh& mesh, const Transform& wall, const Opening& o, double thickness, int lights) {
  const double y = thickness / 2, bar = 0.06;
  for (int k = 0; k <= lights; ++k) {
    const double x = o.x0 + (o.x1 - o.x0 - bar) * k / lights;
    add_box(mesh, wall, {x, y - 0.04, o.z0}, {x + bar, y + 0.04, o.z1}, Material::paint_white);
  }
  for (const double z : {o.z0, o.z1 - bar})
    add_box(mesh, wall, {o.x0, y - 0.04, z}, {o.x1, y + 0.04, z + bar}, Material::paint_white);
  add_quad(mesh, wall * Vector3d(o.x0, y, o.z0), wall * Vector3d(o.x1, y, o.z0), wall * Vector3d(o.x1, y, o.z1),
           wall * Vector3d(o.x0, y, o.z1), Material::glass);
}

/// Divides a bay's side into one or two rooms and gives the station room its door near the bay's middle.
void divide_bay(RoomRow& row, double x0, double x1, Rng& rng) {
  const double middle = (x0 + x1) / 2 + rng.uniform(-0.3, 0.3);
  const auto room = [&](double a, double b) {
    RoomSpace r;
    r.inside = {a + kInner / 2, b - kInner / 2, row.y0, row.y1};
    row.rooms.push_back(r);
  };
  if (x1 - x0 < 6.0 || chance(rng, 0.4)) {
    room(x0, x1);
    row.door_x.push_back(middle);
    return;
  }
  const double reach = rng.uniform(0.8, 1.1);
  const bool left = chance(rng, 0.5);
  const double split = middle + (left ? reach : -reach) * 0.8;
  room(x0, split);
  room(split, x1);
  row.door_x.push_back(split + (left ? -reach : reach));
}

/// The wall between corridor and rooms, with doors, leaves and an occasional pane beside a door.
void add_corridor_wall(Floor& floor, RoomRow& row, RoomSpace& corridor, Rng& rng) {
  const double y_wall = row.door_at_y1 ? row.y1 : row.y0 - kInner, into = row.door_at_y1 ? -1.0 : 1.0;
  const double y_leaf = row.door_at_y1 ? row.y1 : row.y0;
  std::vector<Opening> openings, panes;
  for (RoomSpace& room : row.rooms) {
    const auto own =
        std::ranges::find_if(row.door_x, [&](double x) { return x > room.inside.x0 && x < room.inside.x1; });
    const bool has_station = own != row.door_x.end();
    const double width = has_station ? rng.uniform(1.0, 1.35) : rng.uniform(0.85, 1.0);
    const double low = room.inside.x0 + width / 2 + 0.1, high = room.inside.x1 - width / 2 - 0.1;
    const double x = std::clamp(has_station ? *own : rng.uniform(low, std::max(low, high)), low, std::max(low, high));
    openings.push_back({x - width / 2, x + width / 2, 0, kDoorHeight});
    add_door_leaf(floor.mesh, x - width / 2, x + width / 2, y_leaf, into, has_station || chance(rng, 0.5), rng);
    const double swing = 1.3;
    room.keep_out.push_back(
        {x - swing, x + swing, row.door_at_y1 ? row.y1 - 2.6 : row.y0, row.door_at_y1 ? row.y1 : row.y0 + 2.6});
    corridor.keep_out.push_back({x - 0.9, x + 0.9, corridor.inside.y0, corridor.inside.y1});
    const double pane = rng.uniform(0.6, 1.6), beside = x + width / 2 + 0.15;
    if (chance(rng, 0.3) && beside + pane < room.inside.x1) {
      panes.push_back({beside, beside + pane, 0.9, kDoorHeight});
      openings.push_back(panes.back());
      const double y0 = row.door_at_y1 ? row.y1 - 0.4 : row.y0;
      room.keep_out.push_back({beside, beside + pane, y0, y0 + 0.4});
      corridor.keep_out.push_back({beside, beside + pane, corridor.inside.y0, corridor.inside.y1});
    }
  }
  const Transform wall = wall_along_x(0, y_wall);
  for (const Opening& pane : panes) add_window(floor.mesh, wall, pane, kInner, 1);
  add_wall(floor.mesh, wall, floor.length(), floor.height, kInner, openings, Material::plaster);
}

/// Walls between the rooms of a row, some with an open door.
void add_partitions(Floor& floor, RoomRow& row, Rng& rng) {
  for (std::size_t k = 0; k + 1 < row.rooms.size(); ++k) {
    RoomSpace &left = row.rooms[k], &right = row.rooms[k + 1];
    const double x = left.inside.x1, depth = row.y1 - row.y0;
    std::vector<Opening> openings;
    if (chance(rng, 0.2)) {
      const double from_corridor = rng.uniform(2.8, depth - 1.2);
      const double y = row.door_at_y1 ? depth - from_corridor : from_corridor;
      openings.push_back({y - 0.45, y + 0.45, 0, kDoorHeight});
      left.keep_out.push_back({x - 1.0, x, row.y0 + y - 0.6, row.y0 + y + 0.6});
      right.keep_out.push_back({x + kInner, x + kInner + 1.0, row.y0 + y - 0.6, row.y0 + y + 0.6});
    }
    add_wall(floor.mesh, wall_along_y(x, row.y0, kInner), depth, floor.height, kInner, openings, Material::plaster);
  }
  for (const double x : {-kInner, floor.length()}) {
    if (!floor.has_cross) continue;  // the outer walls close the ends
    add_wall(floor.mesh, wall_along_y(x, row.y0 - kInner, kInner), row.y1 - row.y0 + 2 * kInner, floor.height, kInner,
             {}, Material::plaster);
  }
}

/// The facade of an outer row: the same window over and over, a sill and radiators below.
void add_facade(Floor& floor, RoomRow& row, Rng& rng) {
  const double y = row.door_at_y1 ? row.y0 - kOuter : row.y1;
  const Transform wall = wall_along_x(floor.west() - kOuter, y);
  std::vector<Opening> openings;
  for (RoomSpace& room : row.rooms) {
    const double width = room.inside.x1 - room.inside.x0, pitch = floor.window_width + 0.5;
    const int count = static_cast<int>((width - 0.4) / pitch);
    for (int k = 0; k < count; ++k) {
      const double x = room.inside.x0 + width * (k + 0.5) / count;
      const double in_wall = x - floor.west() + kOuter;
      const Opening o{in_wall - floor.window_width / 2, in_wall + floor.window_width / 2, floor.sill,
                      floor.height - 0.3};
      openings.push_back(o);
      add_window(floor.mesh, wall, o, kOuter, 2);
      if (chance(rng, 0.3)) {  // a blind, half drawn
        const double drawn = rng.uniform(0.2, 0.8) * (o.z1 - o.z0), inner = row.door_at_y1 ? kOuter - 0.04 : 0.02;
        add_box(floor.mesh, wall, {o.x0, inner, o.z1 - drawn}, {o.x1, inner + 0.02, o.z1}, Material::cloth_light);
      }
      const double y_face = row.door_at_y1 ? row.y0 : row.y1;
      const Transform r = upright({x, y_face, 0}, row.door_at_y1 ? 0.0 : kPi);
      if (chance(rng, 0.7)) {
        for (int rib = 0; rib < 10; ++rib) {
          add_box(floor.mesh, r, {-0.5 + 0.1 * rib, 0.03, 0.12}, {-0.43 + 0.1 * rib, 0.12, 0.7}, Material::paint_white);
        }
      }
      const double low = row.door_at_y1 ? row.y0 : row.y1 - 0.2;
      room.keep_out.push_back({x - 0.6, x + 0.6, low, low + 0.2});
    }
  }
  add_wall(floor.mesh, wall, floor.east() - floor.west() + 2 * kOuter, floor.height, kOuter, openings,
           Material::plaster);
}

/// Duct, cable tray and fire-door portals of a corridor.
void add_corridor_fittings(Floor& floor, const Corridor& c, RoomSpace& space, Rng& rng) {
  const bool south = chance(rng, 0.5);
  const double width = rng.uniform(0.25, 0.5), drop = rng.uniform(0.25, 0.4);
  const double y = south ? c.y0 : c.y1 - width;
  add_box(floor.mesh, upright({0, y, floor.height - drop}, 0), {0, 0, 0}, {floor.length(), width, drop - 0.08},
          Material::metal);
  for (double x = rng.uniform(0.5, 1.5); x < floor.length(); x += rng.uniform(1.2, 2.0)) {
    add_box(floor.mesh, upright({x, y, floor.height - drop - 0.03}, 0), {0, -0.0, 0}, {0.04, width, 0.03},
            Material::metal);
  }
  const double pipe = south ? c.y1 - 0.15 : c.y0 + 0.15;
  add_frustum(floor.mesh, {0, pipe, floor.height - 0.15}, {floor.length(), pipe, floor.height - 0.15}, 0.05, 0.05, 10,
              Material::metal);
  for (std::size_t k = 1; k + 1 < floor.bay_x.size(); ++k) {
    if (!chance(rng, 0.6)) continue;
    const double x = floor.bay_x[k], stub = rng.uniform(0.2, 0.5);
    const Transform f = upright({x, 0, 0}, 0);
    add_box(floor.mesh, f, {-0.08, c.y0, 0}, {0.08, c.y0 + stub, floor.height}, Material::plaster);
    add_box(floor.mesh, f, {-0.08, c.y1 - stub, 0}, {0.08, c.y1, floor.height}, Material::plaster);
    add_box(floor.mesh, f, {-0.08, c.y0 + stub, 2.15}, {0.08, c.y1 - stub, floor.height}, Material::plaster);
    space.keep_out.push_back({x - 0.2, x + 0.2, c.y0, c.y1});
  }
}

RoomRow plan_row(const Floor& floor, double y0, double depth, bool door_at_y1, Rng& rng) {
  RoomRow row;
  row.y0 = y0;
  row.y1 = y0 + depth;
  row.door_at_y1 = door_at_y1;
  for (std::size_t b = 0; b + 1 < floor.bay_x.size(); ++b) divide_bay(row, floor.bay_x[b], floor.bay_x[b + 1], rng);
  // The clear inside of the end rooms starts at the wall, not at half a partition.
  row.rooms.front().inside.x0 = 0;
  row.rooms.back().inside.x1 = floor.length();
  return row;
}

Floor plan_floor(const SceneRequest& request, Rng& rng) {
  constexpr int kPerBay = 3, kMaxSingle = 12;
  const int n = request.num_stations;
  const int corridors = n <= kMaxSingle ? 1 : std::max(2, static_cast<int>(std::lround(std::sqrt(n / 7.5))));
  const int bays =
      std::max(corridors > 1 ? 2 : 1, (n - 4 * (corridors - 1) + kPerBay * corridors - 1) / (kPerBay * corridors));
  Floor floor;
  floor.height = rng.uniform(2.6, 3.1);
  floor.corridor_width = rng.uniform(1.9, 2.6);
  floor.window_width = rng.uniform(1.1, 1.9);
  floor.sill = rng.uniform(0.8, 1.0);
  floor.has_cross = corridors > 1;
  floor.bay_x.push_back(0);
  for (int b = 0; b < bays; ++b)
    floor.bay_x.push_back(floor.bay_x.back() + request.spacing_m * rng.uniform(0.85, 1.15));
  double y = 0;
  for (int k = 0; k < corridors; ++k) {
    Corridor c;
    c.south = plan_row(floor, y, rng.uniform(4.5, 6.5), true, rng);
    c.y0 = c.south.y1 + kInner;
    c.y1 = c.y0 + floor.corridor_width;
    c.north = plan_row(floor, c.y1 + kInner, rng.uniform(4.5, 6.5), false, rng);
    c.south.is_outer = k == 0;
    c.north.is_outer = k + 1 == corridors;
    y = c.north.y1 + kInner;
    floor.corridors.push_back(std::move(c));
  }
  return floor;
}

/// Floor and ceiling slabs, walls at the west and east ends, the world outside the windows.
void add_shell(Floor& floor) {
  constexpr double kStreet_m = -9.5;  // a third floor
  const double y0 = floor.corridors.front().south.y0 - kOuter, y1 = floor.corridors.back().north.y1 + kOuter;
  const double x0 = floor.west() - kOuter, x1 = floor.east() + kOuter;
  const Transform origin = Transform::Identity();
  add_box(floor.mesh, origin, {x0, y0, -0.4}, {x1, y1, 0}, Material::carpet);
  add_box(floor.mesh, origin, {x0, y0, floor.height}, {x1, y1, floor.height + 0.4}, Material::plaster);
  for (const double x : {x0, x1 - kOuter}) {
    std::vector<Opening> openings;
    for (const Corridor& c : floor.corridors) openings.push_back({c.y0 - y0 + 0.4, c.y1 - y0 - 0.4, 1.0, 2.3});
    const Transform wall = wall_along_y(x, y0, kOuter);
    for (const Opening& o : openings) add_window(floor.mesh, wall, o, kOuter, 1);
    add_wall(floor.mesh, wall, y1 - y0, floor.height, kOuter, openings, Material::plaster);
  }
  const double far = 90;
  add_box(floor.mesh, origin, {x0 - far, y0 - far, kStreet_m - 1}, {x1 + far, y1 + far, kStreet_m}, Material::asphalt);
  add_box(floor.mesh, origin, {x0 - 30, y0 - 38, kStreet_m}, {x0 + 0.6 * (x1 - x0), y0 - 24, 6}, Material::brick);
  add_box(floor.mesh, origin, {x0 + 0.3 * (x1 - x0), y1 + 19, kStreet_m}, {x1 + 25, y1 + 33, 9}, Material::concrete);
}

Vector3d room_station(const RoomRow& row, double door_x, Rng& rng) {
  const double inward = rng.uniform(1.3, 2.3), sideways = rng.uniform(-0.6, 0.6), height = tripod_height_m(rng);
  return {door_x + sideways, row.door_at_y1 ? row.y1 - inward : row.y0 + inward, height};
}

/// Up and down the corridors, then back through the cross corridors not walked yet.
std::vector<Vector3d> walk(const Floor& floor, int num_stations, Rng& rng) {
  std::vector<Vector3d> stations;
  const auto crossing = [&](std::size_t corridor, bool east) {
    const double x = east ? floor.length() + kInner + floor.corridor_width / 2 : -kInner - floor.corridor_width / 2;
    const Corridor& c = floor.corridors[corridor];
    stations.emplace_back(x + rng.uniform(-0.3, 0.3), (c.y0 + c.y1) / 2 + rng.uniform(-0.3, 0.3), tripod_height_m(rng));
  };
  const std::size_t bays = floor.bay_x.size() - 1, corridors = floor.corridors.size();
  for (std::size_t k = 0; k < corridors; ++k) {
    const Corridor& c = floor.corridors[k];
    const bool eastward = k % 2 == 0;
    if (k > 0) crossing(k, !eastward);
    for (std::size_t step = 0; step < bays; ++step) {
      const std::size_t b = eastward ? step : bays - 1 - step;
      const double x = (c.south.door_x[b] + c.north.door_x[b]) / 2 + rng.uniform(-0.3, 0.3);
      stations.emplace_back(x, (c.y0 + c.y1) / 2 + rng.uniform(-0.3, 0.3), tripod_height_m(rng));
      stations.push_back(room_station(c.south, c.south.door_x[b], rng));
      stations.push_back(room_station(c.north, c.north.door_x[b], rng));
    }
    if (k + 1 < corridors) crossing(k, eastward);
  }
  for (std::size_t k = corridors; k-- > 0;) {
    const bool end_is_east = k % 2 == 0, start_is_east = !end_is_east;
    if (k + 1 == corridors) crossing(k, end_is_east);
    if (k == 0 && corridors > 1) crossing(k, start_is_east);
  }
  stations.resize(std::min(stations.size(), static_cast<std::size_t>(num_stations)));
  return stations;
}

}  // namespace

Scene build_office(const SceneRequest& request) {
  Rng rng(seed_of(request.seed, "office"));
  Floor floor = plan_floor(request, rng);
  for (std::size_t k = 0; k < floor.corridors.size(); ++k) {
    Corridor& c = floor.corridors[k];
    RoomSpace space;
    space.inside = {0, floor.length(), c.y0, c.y1};
    space.height_m = floor.height;
    space.is_corridor = true;
    for (const double x : c.south.door_x) space.keep_out.push_back({x - 1.2, x + 1.2, c.y0, c.y1});
    for (RoomRow* row : {&c.south, &c.north}) {
      add_corridor_wall(floor, *row, space, rng);
      add_partitions(floor, *row, rng);
      if (row->is_outer) add_facade(floor, *row, rng);
      for (RoomSpace& room : row->rooms) {
        room.height_m = floor.height;
        furnish(floor.mesh, room, rng);
      }
    }
    add_corridor_fittings(floor, c, space, rng);
    furnish(floor.mesh, space, rng);
    if (k > 0) {  // the wall between two rows of rooms, back to back
      add_box(floor.mesh, Transform::Identity(), {-kInner, c.south.y0 - kInner, 0},
              {floor.length() + kInner, c.south.y0, floor.height}, Material::plaster);
    }
  }
  add_shell(floor);
  Scene scene;
  scene.stations = walk(floor, request.num_stations, rng);
  scene.mesh = std::move(floor.mesh);
  scene.people_per_scan = 1.5;
  return scene;
}

}  // namespace isthmus::sim
