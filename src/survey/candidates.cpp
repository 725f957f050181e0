#include "survey/candidates.h"

#include <fnmatch.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>

#include "base/parallel.h"
#include "regions/plan_likeness.h"
#include "survey/spanning_forest.h"

namespace isthmus {
namespace {

using Pair = std::pair<int, int>;  // positions among the scans sorted by name, smaller first

/// The scans sorted by name (byte by byte, as ids are), and what every choice needs to know of their pairs.
struct Survey {
  std::vector<const CandidateInput*> scans;
  std::vector<double> likeness;  // of words; n x n, symmetric
  std::vector<double> promise;   // n x n: what each row's scan expects of each other, 1 at best
  std::vector<double> scores;    // likewise: promise, glances and distance together
  CandidateOptions options;

  [[nodiscard]] int size() const { return static_cast<int>(scans.size()); }
  /// What scan a expects of scan b.
  [[nodiscard]] double score(int a, int b) const { return scores[static_cast<std::size_t>(a) * scans.size() + b]; }
  [[nodiscard]] double score_of_pair(int a, int b) const { return std::max(score(a, b), score(b, a)); }
  [[nodiscard]] std::optional<double> distance_m(int a, int b) const {
    if (!scans[a]->prior_position || !scans[b]->prior_position) return std::nullopt;
    return (*scans[a]->prior_position - *scans[b]->prior_position).norm();
  }
  [[nodiscard]] bool allowed(int a, int b) const {
    const std::optional<double> d = distance_m(a, b);
    return !(d && options.max_distance_m && *d > *options.max_distance_m);
  }
};

/// Median over the scans of the distance to the k-th nearest one, among those with a prior position.
double neighbour_distance_m(const Survey& survey) {
  std::vector<double> kth;
  for (int a = 0; a < survey.size(); ++a) {
    std::vector<double> distances;
    for (int b = 0; b < survey.size(); ++b)
      if (const auto d = a == b ? std::nullopt : survey.distance_m(a, b)) distances.push_back(*d);
    if (distances.empty()) continue;
    std::sort(distances.begin(), distances.end());
    kth.push_back(
        distances[std::min<std::size_t>(distances.size(), static_cast<std::size_t>(survey.options.pairs_per_scan)) -
                  1]);
  }
  if (kth.empty()) return 0;
  std::nth_element(kth.begin(), kth.begin() + static_cast<std::ptrdiff_t>(kth.size() / 2), kth.end());
  return kth[kth.size() / 2];
}

void compare(Survey& survey) {
  std::vector<survey::DescriptorView> views;
  bool all_upright = true;
  for (const CandidateInput* scan : survey.scans) {
    views.push_back(scan->descriptors);
    all_upright = all_upright && (scan->descriptors.num_keypoints == 0 || !scan->descriptors.heights_voxels.empty());
  }
  const std::vector<survey::WordBag> at_heights = survey::weighted_bags(views, true);
  const std::vector<survey::WordBag> anywhere =
      all_upright ? std::vector<survey::WordBag>{} : survey::weighted_bags(views, false);
  const std::size_t n = survey.scans.size();
  const auto upright = [&](std::size_t a, std::size_t b) {
    return all_upright || (!views[a].heights_voxels.empty() && !views[b].heights_voxels.empty());
  };
  survey.likeness.assign(n * n, 0.0);
  std::vector<double> beside(all_upright ? 0 : n * n, 0.0);  // without heights, of pairs that have them
  parallel_for_index(n, 1, [&](std::size_t a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      const std::vector<survey::WordBag>& bags = upright(a, b) ? at_heights : anywhere;
      survey.likeness[a * n + b] = survey.likeness[b * n + a] = survey::likeness(bags[a], bags[b]);
      if (!all_upright && upright(a, b)) beside[a * n + b] = survey::likeness(anywhere[a], anywhere[b]);
    }
  });
  if (all_upright) return;
  // Words without heights are shared more often: the two kinds are made comparable by the pairs that have both.
  double with_heights = 0, without = 0;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b)
      if (upright(a, b)) with_heights += survey.likeness[a * n + b], without += beside[a * n + b];
  if (!(with_heights > 0 && without > 0)) return;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < n; ++b)
      if (a != b && !upright(a, b)) survey.likeness[a * n + b] *= with_heights / without;
}

std::vector<float> compare_in_parallel(std::span<const std::pair<int, int>> pairs,
                                       const std::function<float(std::size_t)>& compare) {
  std::vector<float> out(pairs.size(), 0.0F);
  parallel_for_index(pairs.size(), 1, [&](std::size_t k) { out[k] = compare(k); });
  return out;
}

/// How well the plans of each two scans can be laid on each other; 0 where one has none.
std::vector<double> likeness_of_plans(const Survey& survey, const ComparePlans& compare_plans) {
  const std::size_t n = survey.scans.size();
  std::vector<std::pair<std::size_t, std::size_t>> places;
  std::vector<std::pair<int, int>> pairs;
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = a + 1; b < n; ++b) {
      const CandidateInput &first = *survey.scans[a], &second = *survey.scans[b];
      if (!first.plan || !second.plan || !survey.allowed(static_cast<int>(a), static_cast<int>(b))) continue;
      places.emplace_back(a, b);
      pairs.emplace_back(first.id, second.id);
    }
  const auto compare = [&](std::size_t k) {
    const CandidateInput &first = *survey.scans[places[k].first], &second = *survey.scans[places[k].second];
    const float as_is = plan_likeness(*first.plan, *second.plan);
    if (first.knows_up && second.knows_up) return as_is;
    return std::max(as_is, plan_likeness(*first.plan, upside_down(*second.plan)));
  };
  const std::vector<float> answers =
      compare_plans ? compare_plans(pairs, compare) : compare_in_parallel(pairs, compare);
  std::vector<double> likeness(n * n, 0.0);
  for (std::size_t k = 0; k < places.size(); ++k) {
    const auto [a, b] = places[k];
    likeness[a * n + b] = likeness[b * n + a] = static_cast<double>(answers[k]);
  }
  return likeness;
}

/// What each scan expects of each other: the ranks that words and plans give it, fused. Where one of two has no plan,
/// or plans were not asked (`of_plans` is empty), words speak for both.
void fuse(Survey& survey, const std::vector<double>& of_plans) {
  constexpr double kSoftening = 5;         // ranks within about this many of each other are nearly equal
  constexpr double kBetweenEquals = 1e-3;  // of pairs with equal ranks the one with more words in common
  const std::size_t n = survey.scans.size();
  survey.promise.assign(n * n, 0.0);
  for (std::size_t a = 0; a < n; ++a) {
    const auto add_ranks = [&](const std::vector<double>& by, const auto& weight) {
      std::vector<std::size_t> others;
      for (std::size_t b = 0; b < n; ++b)
        if (b != a && by[a * n + b] > 0) others.push_back(b);
      std::stable_sort(others.begin(), others.end(),
                       [&](std::size_t x, std::size_t y) { return by[a * n + x] > by[a * n + y]; });
      std::size_t rank = 0;  // equals share it
      for (std::size_t k = 0; k < others.size(); ++k) {
        if (k > 0 && by[a * n + others[k]] < by[a * n + others[k - 1]]) rank = k;
        survey.promise[a * n + others[k]] += weight(others[k]) * kSoftening / (kSoftening + static_cast<double>(rank));
      }
    };
    const auto has_plans = [&](std::size_t b) {
      return !of_plans.empty() && survey.scans[a]->plan && survey.scans[b]->plan;
    };
    add_ranks(survey.likeness, [&](std::size_t b) { return has_plans(b) ? 0.5 : 1.0; });
    if (!of_plans.empty()) add_ranks(of_plans, [](std::size_t) { return 0.5; });
    for (std::size_t b = 0; b < n; ++b) {
      double& promise = survey.promise[a * n + b];
      promise += kBetweenEquals * (survey.likeness[a * n + b] - promise);
    }
  }
}

/// Promise, and beside glances a tenth of it: a clear glance decides.
void compute_scores(Survey& survey, const std::map<Pair, double>& glances) {
  constexpr double kPromiseBesideGlance = 0.1;
  const double typical_m = neighbour_distance_m(survey);
  const std::size_t n = survey.scans.size();
  survey.scores.assign(n * n, 0.0);
  for (int a = 0; a < survey.size(); ++a)
    for (int b = 0; b < survey.size(); ++b) {
      if (a == b) continue;
      const std::size_t at = static_cast<std::size_t>(a) * n + static_cast<std::size_t>(b);
      double score = survey.promise[at];
      if (!glances.empty()) {
        const auto glance = glances.find(std::minmax(a, b));
        score = kPromiseBesideGlance * score + (glance != glances.end() ? glance->second : 0.0);
      }
      const std::optional<double> d = survey.distance_m(a, b);
      if (d && typical_m > 0) score = (score + 1.0) / (2.0 * (1.0 + *d * *d / (typical_m * typical_m)));
      survey.scores[at] = score;
    }
}

void add(std::map<Pair, const char*>& chosen, int a, int b, const char* why) {
  if (a != b) chosen.try_emplace({std::min(a, b), std::max(a, b)}, why);
}

void add_groups(const Survey& survey, std::map<Pair, const char*>& chosen, std::vector<std::string>& warnings) {
  for (const std::string& group : survey.options.groups) {
    std::set<int> members;
    std::istringstream words(group);
    for (std::string pattern; words >> pattern;) {
      bool matched = false;
      for (int i = 0; i < survey.size(); ++i)
        if (survey.scans[i]->name == pattern || ::fnmatch(pattern.c_str(), survey.scans[i]->name.c_str(), 0) == 0)
          members.insert(i), matched = true;
      if (!matched) warnings.push_back(fmt::format("candidates.groups: '{}' matches no scan that was read", pattern));
    }
    for (const int a : members)
      for (const int b : members)
        if (a < b) add(chosen, a, b, "group");
  }
}

void add_file_order(const Survey& survey, std::map<Pair, const char*>& chosen) {
  std::vector<int> order(survey.scans.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return natural_less(survey.scans[a]->name, survey.scans[b]->name); });
  for (int i = 0; i < survey.size(); ++i)
    for (int k = 1; k <= survey.options.file_order_neighbours && i + k < survey.size(); ++k)
      if (survey.allowed(order[i], order[i + k])) add(chosen, order[i], order[i + k], "file order");
}

void add_most_alike(const Survey& survey, std::size_t per_scan, std::map<Pair, const char*>& chosen) {
  for (int a = 0; a < survey.size(); ++a) {
    std::vector<int> others;
    for (int b = 0; b < survey.size(); ++b)
      if (b != a && survey.allowed(a, b)) others.push_back(b);
    std::stable_sort(others.begin(), others.end(),
                     [&](int x, int y) { return survey.score(a, x) > survey.score(a, y); });
    others.resize(std::min(others.size(), per_scan));
    for (const int b : others) add(chosen, a, b, "likeness");
  }
}

/// Pairs that were not chosen and may be.
std::map<Pair, const char*> rest_of(const Survey& survey, const std::map<Pair, const char*>& chosen) {
  std::map<Pair, const char*> rest;
  for (int a = 0; a < survey.size(); ++a)
    for (int b = a + 1; b < survey.size(); ++b)
      if (survey.allowed(a, b) && !chosen.contains({a, b})) rest.emplace(Pair{a, b}, "likeness");
  return rest;
}

void warn_of_parts(const Survey& survey, std::vector<std::string>& warnings) {
  survey::DisjointSets sets(survey.size());
  for (int a = 0; a < survey.size(); ++a)
    for (int b = a + 1; b < survey.size(); ++b)
      if (survey.allowed(a, b)) sets.join(a, b);
  std::set<int> parts;
  for (int i = 0; i < survey.size(); ++i) parts.insert(sets.find(i));
  if (parts.size() > 1)
    warnings.push_back(fmt::format(
        "the candidate pairs leave {} unconnected parts: candidates.max_distance_m forbids the rest", parts.size()));
}

std::vector<Candidate> ranked(const Survey& survey, const std::map<Pair, const char*>& chosen) {
  std::vector<Candidate> out;
  for (const auto& [pair, why] : chosen)
    out.push_back({survey.scans[pair.second]->id, survey.scans[pair.first]->id,
                   survey.score_of_pair(pair.first, pair.second), why});
  std::stable_sort(out.begin(), out.end(), [](const Candidate& x, const Candidate& y) { return x.score > y.score; });
  return out;
}

/// What glances at each scan's most alike find.
std::map<Pair, double> glances_at(const Survey& survey, const CastGlances& cast) {
  std::map<Pair, const char*> chosen;
  add_most_alike(survey, static_cast<std::size_t>(survey.options.screened_per_scan), chosen);
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [pair, why] : chosen)
    pairs.emplace_back(survey.scans[pair.second]->id, survey.scans[pair.first]->id);
  std::map<int, int> place_of_id;
  for (int i = 0; i < survey.size(); ++i) place_of_id[survey.scans[i]->id] = i;
  std::map<Pair, double> found;
  for (const ScreenedPair& s : cast(pairs))
    found[std::minmax(place_of_id.at(s.source), place_of_id.at(s.target))] = std::max(0.0, s.score);
  return found;
}

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  const auto is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const auto number = [&](std::string_view s, std::size_t& at) {
        while (at < s.size() && s[at] == '0') ++at;
        const std::size_t start = at;
        while (at < s.size() && is_digit(s[at])) ++at;
        return s.substr(start, at - start);
      };
      const std::string_view x = number(a, i), y = number(b, j);
      if (x.size() != y.size()) return x.size() < y.size();
      if (x != y) return x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i, ++j;
    }
  }
  if (i < a.size() || j < b.size()) return j < b.size();
  return a < b;  // equal but for leading zeros
}

CandidateGraph propose_candidates(std::span<const CandidateInput> scans, const CandidateOptions& options,
                                  const CastGlances& cast, const ComparePlans& compare_plans) {
  Survey survey;
  survey.options = options;
  for (const CandidateInput& scan : scans) survey.scans.push_back(&scan);
  std::sort(survey.scans.begin(), survey.scans.end(),
            [](const CandidateInput* a, const CandidateInput* b) { return a->name < b->name; });
  compare(survey);
  const bool all_pairs = survey.size() <= options.all_pairs_up_to;
  const bool choosy = !all_pairs && !options.only_groups;  // otherwise scores only order what is tried
  fuse(survey, choosy ? likeness_of_plans(survey, compare_plans) : std::vector<double>{});
  compute_scores(survey, {});
  if (cast && choosy) compute_scores(survey, glances_at(survey, cast));
  CandidateGraph graph;
  std::map<Pair, const char*> chosen;
  add_groups(survey, chosen, graph.warnings);
  if (!options.only_groups) {
    add_file_order(survey, chosen);
    if (all_pairs) {
      for (int a = 0; a < survey.size(); ++a)
        for (int b = a + 1; b < survey.size(); ++b)
          if (survey.allowed(a, b)) add(chosen, a, b, "all pairs");
    } else {
      // Half of the budget at first: the rest goes where the first results leave scans unplaced.
      add_most_alike(survey, static_cast<std::size_t>((options.pairs_per_scan + 1) / 2), chosen);
      graph.reserve = ranked(survey, rest_of(survey, chosen));
    }
    warn_of_parts(survey, graph.warnings);
  }
  graph.candidates = ranked(survey, chosen);
  return graph;
}

}  // namespace isthmus
