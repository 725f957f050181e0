// Things that furnish scenes. Each stands at its frame's origin on z = 0, front towards +x unless said otherwise.
#pragma once

#include "base/rng.h"
#include "simulate/mesh.h"

namespace isthmus::sim {

// People and vehicles
void add_person(Mesh& mesh, const Transform& world_from_person, Rng& rng);
void add_car(Mesh& mesh, const Transform& world_from_car, Rng& rng);  ///< about 4.3 x 1.8 m, centred

// Rooms; footprints in the comments, backs towards -y at y = 0 (against a wall), x centred
void add_desk(Mesh& mesh, const Transform& world_from_desk, Rng& rng);    ///< 1.6 x 0.8
void add_chair(Mesh& mesh, const Transform& world_from_chair, Rng& rng);  ///< 0.55 x 0.55, centred
void add_table(Mesh& mesh, const Transform& world_from_table, double length, double width, Rng& rng);  ///< centred
void add_shelf(Mesh& mesh, const Transform& world_from_shelf, double width, double height, Rng& rng);  ///< width x 0.35
void add_cabinet(Mesh& mesh, const Transform& world_from_cabinet, double width, double height, Rng& rng);  ///< x 0.45
void add_sofa(Mesh& mesh, const Transform& world_from_sofa, double width, Rng& rng);                       ///< x 0.9
void add_counter(Mesh& mesh, const Transform& world_from_counter, double width, Rng& rng);  ///< kitchen, width x 0.6
void add_pot_plant(Mesh& mesh, const Transform& world_from_plant, Rng& rng);                ///< 0.6 x 0.6, centred
void add_radiator(Mesh& mesh, const Transform& world_from_radiator, double width);          ///< width x 0.12

// Outdoors
void add_lamp_post(Mesh& mesh, const Transform& world_from_post, double height, Rng& rng);
void add_bench(Mesh& mesh, const Transform& world_from_bench);
void add_bin(Mesh& mesh, const Transform& world_from_bin, Rng& rng);
void add_traffic_sign(Mesh& mesh, const Transform& world_from_sign, Rng& rng);

}  // namespace isthmus::sim
