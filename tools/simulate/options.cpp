#include "simulate/scene.h"
#include "simulate/simulate.h"

namespace isthmus {

const config::OptionTable<SimulateOptions>& simulate_options_table() {
  using O = SimulateOptions;
  static const config::OptionTable<O> table = [] {
    config::OptionTable<O> t;
    t.stage = "simulate";
    t.help = "Makes a survey with exact ground truth by ray casting.";
    const auto add = [&t](std::string key, config::Member<O> member, std::string unit, std::string help,
                          std::string source) -> config::OptionRow<O>& {
      config::OptionRow<O>& row = t.rows.emplace_back();
      row.key = std::move(key);
      row.member = member;
      row.unit = std::move(unit);
      row.help = std::move(help);
      row.source = std::move(source);
      return row;
    };
    const auto range = [](config::OptionRow<O>& row, double low, double high) {
      row.min = low;
      row.max = high;
    };
    constexpr double kNoLimit = std::numeric_limits<int>::max();
    add("scene", &O::scene, "", "The kind of place.", "the kinds of survey method.md was measured on").choices =
        sim::scene_names();
    add("output", &O::output, "", "Folder for the scans and the truth.", "-").affects_results = false;
    add("format", &O::format, "", "File format of the scans.", "PLY is read by everything").choices = {"ply", "pcd",
                                                                                                       "xyz"};
    range(add("stations", &O::stations, "", "Number of stations; the place grows with it.", "a morning's work"), 1,
          2000);
    range(add("resolution_deg", &O::resolution_deg, "deg",
              "Angle between neighbouring rays, both ways. 0.1 gives about 5 million points.",
              "middle setting of terrestrial scanners (10 mm at 6 m)"),
          0.005, 10);
    range(add("seed", &O::seed, "", "Another seed, another place. The same seed gives the same bytes.", "arbitrary"), 0,
          kNoLimit);
    range(add("spacing_m", &O::spacing_m, "m",
              "Distance between neighbouring stations; automatic: the scene's own, little overlap but connected.",
              "docs/simulate.md, table of overlaps"),
          2, 500);
    add("orientation", &O::orientation, "",
        "yaw: unknown headings, levelled; full: coordinates turned at random in 3-D; none: headings known.",
        "terrestrial scanners level themselves but do not know north")
        .choices = {"yaw", "full", "none"};
    range(add("tilt_deg", &O::tilt_deg, "deg", "Sigma of the instrument's tilt about each horizontal axis.",
              "dual-axis compensators state 0.005 to 0.02 degrees"),
          0, 45);
    range(add("min_range_m", &O::min_range_m, "m", "Closer returns are not measured.", "data sheets: 0.3 to 0.6 m"), 0,
          10);
    range(add("max_range_m", &O::max_range_m, "m", "Farther returns are not measured.",
              "data sheets of phase scanners: 70 to 130 m"),
          1, 5000);
    range(add("noise_m", &O::noise_m, "m", "Sigma of the range noise.", "data sheets: 1 to 3 mm at 10 m"), 0, 1);
    range(add("noise_ppm", &O::noise_ppm, "ppm", "Added to that sigma per metre of range.", "data sheets: 10 ppm"), 0,
          100000);
    range(add("beam_mrad", &O::beam_mrad, "mrad",
              "Full divergence of the beam; decides how many points mix two surfaces at an edge. 0: none.",
              "data sheets: 0.2 to 0.4 mrad"),
          0, 20);
    range(add("dropouts", &O::dropouts, "", "Share of returns lost for no reason.", "a guess"), 0, 1);
    add("signal_loss", &O::signal_loss, "", "Dark, distant and grazing surfaces lose returns.", "radar equation");
    add("glass", &O::glass, "",
        "Panes let beams through, mirror them into ghosts or swallow them. false: panes are invisible.",
        "Schlick 1994");
    add("movers", &O::movers, "", "People and cars that stand elsewhere in every scan.", "any street");
    add("keep_no_return", &O::keep_no_return, "",
        "Rays without a return are written as points at the origin, so that the grid stays whole (as in PTX).", "PTX");
    range(add("foreign", &O::foreign, "",
              "So many scans of other places among the others; named in foreign.txt, absent from poses.gt.txt.",
              "surveys with a stray file"),
          0, 1000);
    return t;
  }();
  return table;
}

}  // namespace isthmus
