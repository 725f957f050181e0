#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "evaluate/evaluate.h"

namespace isthmus::evaluate {

std::string text_of(const Evaluation& e) {
  std::string out =
      fmt::format("links   {} of {} right, {} wrong (2 deg and 2 voxels of {:g} m at the source's centroid)\n", e.right,
                  e.edges, e.wrong.size(), e.voxel_m);
  out += "recall ";
  for (const Band& band : e.bands) out += fmt::format("  {} {}/{}", band.name, band.found, band.pairs);
  out += fmt::format("\nplaced  {} of {} scans, {} of them placeable by overlaps above 10 %\n",
                     e.poses ? e.poses->placed : 0, e.poses ? e.poses->of : 0, e.placeable);
  if (e.poses)
    out += fmt::format(
        "poses   {} within the limits; median {:.4f} deg, {:.5f} m; worst {:.4f} deg, {:.5f} m; parts of {}\n",
        e.poses->within, e.poses->median_deg, e.poses->median_m, e.poses->max_deg, e.poses->max_m,
        fmt::join(e.poses->components, ", "));
  for (const WrongEdge& w : e.wrong) {
    out += fmt::format("  wrong link {} -> {}: ", w.source, w.target);
    out += w.rotation_deg ? fmt::format("{:.3f} deg, {:.4f} m", *w.rotation_deg, w.translation_m) : "not in the truth";
    out += w.overlap ? fmt::format(", overlap {:.3f}\n", *w.overlap) : "\n";
  }
  for (const std::string& name : e.unknown_placed) out += fmt::format("  placed but not in the truth: {}\n", name);
  return out;
}

std::string json_of(const Evaluation& e) {
  using Json = nlohmann::ordered_json;
  Json json = {{"voxel_m", e.voxel_m},
               {"edges", e.edges},
               {"right", e.right},
               {"wrong", e.wrong.size()},
               {"placeable", e.placeable}};
  json["recall_by_overlap"] = Json::object();
  for (const Band& band : e.bands) json["recall_by_overlap"][band.name] = fmt::format("{}/{}", band.found, band.pairs);
  json["poses"] = nullptr;
  if (e.poses)
    json["poses"] = {{"placed", e.poses->placed},         {"of", e.poses->of},
                     {"components", e.poses->components}, {"within", e.poses->within},
                     {"med_deg", e.poses->median_deg},    {"med_m", e.poses->median_m},
                     {"max_deg", e.poses->max_deg},       {"max_m", e.poses->max_m}};
  json["unknown_placed"] = e.unknown_placed;
  json["wrong_edges"] = Json::array();
  for (const WrongEdge& w : e.wrong) {
    Json edge = {{"target", w.target}, {"source", w.source}};
    if (w.rotation_deg) edge["deg"] = *w.rotation_deg, edge["m"] = w.translation_m;
    if (w.overlap) edge["overlap"] = *w.overlap;
    json["wrong_edges"].push_back(std::move(edge));
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace isthmus::evaluate
