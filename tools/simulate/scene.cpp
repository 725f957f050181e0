#include "simulate/scene.h"

#include <array>
#include <utility>

namespace isthmus::sim {
namespace {

struct Kind {
  const char* name;
  double spacing_m;
  Scene (*build)(const SceneRequest&);
};

constexpr std::array kKinds = {
    Kind{"office", 9.0, build_office},  Kind{"street", 30.0, build_street}, Kind{"campus", 32.0, build_campus},
    Kind{"forest", 24.0, build_forest}, Kind{"tunnel", 48.0, build_tunnel}, Kind{"hall", 20.0, build_hall},
};

const Kind& kind_of(std::string_view name) {
  for (const Kind& kind : kKinds) {
    if (kind.name == name) return kind;
  }
  return kKinds.front();
}

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Kind& kind : kKinds) all.emplace_back(kind.name);
    return all;
  }();
  return names;
}

double default_spacing_m(std::string_view scene) { return kind_of(scene).spacing_m; }

Scene build_scene(std::string_view scene, const SceneRequest& request) { return kind_of(scene).build(request); }

}  // namespace isthmus::sim
