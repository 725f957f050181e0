#include "pipelines/survey_pipeline.h"

#include <fmt/format.h>
#include <malloc.h>
#include <oneapi/tbb/flow_graph.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <new>
#include <utility>

#include "pipelines/bridge_checks.h"
#include "pipelines/byte_gate.h"
#include "pipelines/confirmed_joins.h"
#include "pipelines/model_pairs.h"
#include "pipelines/pair_rounds.h"
#include "pipelines/pair_stage.h"
#include "pipelines/scan_positions.h"

namespace isthmus::pipelines {
namespace {

namespace flow = oneapi::tbb::flow;

constexpr std::size_t kBytesOfPair =
    96U << 20;  // lookups, range images, hypotheses: measured 45 MB at 25,000 points a scan
constexpr std::size_t kCopiesOfProduct = 2;  // the product itself and its bytes while it is loaded

/// Runs a node's body: what it throws (out of memory, a bug in a library) becomes an error, and waiting loops inside it
/// take no work of other nodes, so that no node begins before the gate let it.
template <class Body>
std::optional<Error> contained(const Body& body) {
  std::optional<Error> error;
  oneapi::tbb::this_task_arena::isolate([&] {
    try {
      body();
    } catch (const std::bad_alloc&) {
      error = Error{"not enough memory", "", "give the program more, or fewer --threads, less --memory"};
    } catch (const std::exception& exception) {
      error = Error{fmt::format("internal failure: {}", exception.what()), "", "please report it with the scan"};
    } catch (...) {
      error = Error{"internal failure of unknown kind", "", "please report it with the scan"};
    }
  });
  return error;
}

struct ScanWork {
  ScanPlan plan;
  ScanOutcome* outcome = nullptr;
  std::unique_ptr<ScanProduct>
      product;  ///< empty when the summary was in the store, the scan failed or a stop was asked for

  [[nodiscard]] bool active() const { return product != nullptr && !outcome->error; }
};
using ScanMessage = std::shared_ptr<ScanWork>;

struct PairWork {
  PairOutcome* outcome = nullptr;
  std::vector<Transform> priors;
  std::size_t bytes = 0;  ///< nothing to speak of for a result that is only looked for in the store
  bool mine = true;
};
using PairMessage = std::shared_ptr<PairWork>;

class SurveyGraph {
 public:
  SurveyGraph(const SurveyPlan& plan, const Settings& settings, const store::Store& store, const Events& events,
              const std::atomic<bool>& stop, const Share& share, SurveyOutcome& out)
      : plan_(plan),
        settings_(settings),
        store_(store),
        events_(events),
        stop_(stop),
        share_(share),
        out_(out),
        maker_(settings, store),
        digests_(digests_of(settings)),
        gate_(memory_bytes_of(settings.run), 2 * static_cast<std::size_t>(threads_of(settings.run))),
        cache_(out.scans.size(), 2 * static_cast<std::size_t>(threads_of(settings.run)),
               [this](int id) { return load_product(id); }) {
    for (const ScanPlan& scan : plan_.scans) plan_of_[scan.id] = &scan;
    connect();
  }

  void run() {
    for (const ScanPlan& scan : plan_.scans) {
      auto work = std::make_shared<ScanWork>();
      work->plan = scan;
      work->outcome = &out_.scans[static_cast<std::size_t>(scan.id)];
      gate_.submit(scan.bytes, [this, work] { read_.try_put(work); });
    }
    graph_.wait_for_all();
    out_.peak_bytes_in_flight = gate_.peak_bytes();
    out_.guessed = looked_for_unmade_;
  }

 private:
  using ScanNode = flow::function_node<ScanMessage, ScanMessage>;
  using PairNode = flow::function_node<PairMessage, PairMessage>;
  using Barrier = flow::multifunction_node<ScanMessage, std::tuple<flow::continue_msg>>;
  using PairBarrier = flow::multifunction_node<PairMessage, std::tuple<flow::continue_msg>>;
  using Step = flow::function_node<flow::continue_msg>;

  void connect() {
    flow::make_edge(read_, describe_);
    flow::make_edge(describe_, divide_);
    flow::make_edge(divide_, all_scans_);
    flow::make_edge(flow::output_port<0>(all_scans_), candidates_);
    flow::make_edge(pair_, all_pairs_);
    flow::make_edge(flow::output_port<0>(all_pairs_), solve_);
  }

  template <class Body>
  ScanMessage step(const ScanMessage& work, const Body& body) {
    if (const auto error = contained(body)) work->outcome->error = error;
    return work;
  }

  void read_and_reduce(ScanWork& work) {
    if (stop_) return;
    work.outcome->summary = store_.load<ScanSummary>(work.plan.summary);
    if (work.outcome->summary) {
      for (const store::Key* key : {&work.plan.sampled, &work.plan.features, &work.plan.regions}) store_.need(*key);
      work.outcome->times.push_back({work.plan.summary.stage, 0, true});
      return;
    }
    if (!share_.has(static_cast<std::size_t>(work.outcome->id))) {
      leave_to_others(work);
      return;
    }
    Result<SampledScan> sampled = maker_.sampled(work.plan, work.outcome->times);
    if (!sampled) {
      work.outcome->error = sampled.error();
      return;
    }
    work.product = std::make_unique<ScanProduct>();
    work.product->sampled = std::move(*sampled);
  }

  /// What went wrong with a scan is told to the other shares, so that they do not wait for it.
  [[nodiscard]] static store::Key trouble_key(const ScanPlan& plan) {
    return store::make_key("trouble", "1", std::array<std::string, 1>{plan.summary.digest});
  }
  void leave_to_others(ScanWork& work) {
    if (const auto text = store_.load<std::string>(trouble_key(work.plan))) {
      work.outcome->error = Error{*text, "", ""};
    } else {
      work.outcome->missing = true;
    }
  }

  void describe(ScanWork& work) {
    if (!work.active()) return;
    Result<FeatureCloud> features = maker_.features(work.plan, work.product->sampled, work.outcome->times);
    if (features) {
      work.product->features = std::move(*features);
    } else {
      work.outcome->error = features.error();
    }
  }

  void divide(ScanWork& work) {
    if (!work.active()) return;
    Result<RegionMap> regions =
        maker_.regions(work.plan, work.product->sampled, work.product->features, work.outcome->times);
    if (!regions) {
      work.outcome->error = regions.error();
      return;
    }
    work.product->regions = std::move(*regions);
    work.outcome->summary = summarise(*work.product);
    store_.keep(work.plan.summary, *work.outcome->summary);
  }

  /// Serial: the end of a scan's walk and the barrier behind it.
  void arrive(const ScanMessage& work, Barrier::output_ports_type& ports) {
    work->product.reset();
    ::malloc_trim(0);
    if (work->outcome->error) {
      work->outcome->error = by_name(*work->outcome->error, work->plan.ref);
      events_.warn(work->outcome->error->text());
      if (share_.count > 1) store_.keep(trouble_key(work->plan), work->outcome->error->text());
    }
    ++scans_done_;
    events_.advance("scans", scans_done_, plan_.scans.size());
    if (scans_done_ == plan_.scans.size()) std::get<0>(ports).try_put({});
    gate_.release(work->plan.bytes);
  }

  [[nodiscard]] bool are_scans_missing() const {
    return std::ranges::any_of(out_.scans, [](const ScanOutcome& scan) { return scan.missing; });
  }

  void choose_candidates() {
    if (stop_ || (are_scans_missing() && !share_.only_looks())) return;
    if (const auto error = contained([&] { propose(); })) warn(error->text());
    ::malloc_trim(0);
    if (stop_) return;
    if (!rounds_ || !submit_all(rounds_->first())) solve_.try_put({});
  }

  /// Begins a wave of pairs; false if there are none. All pairs of the waves before are done.
  bool submit_all(const std::vector<PlannedPair>& pairs) {
    num_pairs_ += pairs.size();
    std::vector<std::pair<std::size_t, std::vector<Transform>>> work;  // by index: the vector of outcomes grows
    for (const PlannedPair& pair : pairs) {
      std::vector<Transform> priors;
      if (pair.target_from_source) priors.push_back(*pair.target_from_source);
      work.emplace_back(index_of(pair), std::move(priors));
    }
    for (auto& [index, priors] : work) submit(out_.pairs[index], std::move(priors));
    return !pairs.empty();
  }

  void propose() {
    std::vector<CandidateInput> inputs;
    const ScanPositions positions = prior_positions();
    const auto position_of = [&](const std::string& name) -> std::optional<Eigen::Vector3d> {
      const auto at = positions.by_name.find(name);
      return at != positions.by_name.end() ? std::optional(at->second) : std::nullopt;
    };
    for (ScanOutcome& scan : out_.scans) {
      const std::string& name = scan.ref.name;
      CandidateInput input{scan.id, name, {}, {}, false, position_of(name)};
      if (scan.summary && !scan.error) {
        ScanSummary& summary = *scan.summary;
        const std::size_t count = summary.dimension == 0 ? 0 : summary.descriptors.size() / summary.dimension;
        input.descriptors = {summary.descriptors, count, summary.heights_voxels};
        input.plan = std::exchange(summary.plan, std::nullopt);
        input.knows_up = summary.knows_up;
      } else if (!scan.missing) {  // what is missing takes part, to look ahead
        continue;
      }
      inputs.push_back(std::move(input));
    }
    const ModelSources sources = model_sources();
    const auto cast = [&](std::span<const std::pair<int, int>> wanted) {
      std::vector<std::pair<int, int>> pairs(wanted.begin(), wanted.end());
      std::erase_if(pairs, [&](const auto& pair) {  // a look ahead may not know a scan
        return !plan_of_.contains(pair.first) || !plan_of_.contains(pair.second);
      });
      return screen_pairs(pairs, sources, events_, stop_);
    };
    const auto compare = [&](std::span<const std::pair<int, int>> pairs, const std::function<float(std::size_t)>& one) {
      return compare_plans(pairs, one, sources, events_, stop_);
    };
    CandidateGraph graph = propose_candidates(inputs, settings_.candidates, cast, compare);
    for (const std::string& warning : graph.warnings) warn(warning);
    rounds_ = std::make_unique<PairRounds>(std::move(graph), settings_.candidates, inputs.size());
    for (ScanOutcome& scan : out_.scans) {  // what only the choice of pairs needed
      if (!scan.summary) continue;
      std::vector<std::uint8_t>().swap(scan.summary->descriptors);
      std::vector<float>().swap(scan.summary->heights_voxels);
    }
  }

  /// The file was in order when the run began; what has become of it since is only worth a warning.
  ScanPositions prior_positions() {
    if (settings_.candidates.positions.empty())
      return settings_.candidates.file_positions ? stored_positions() : ScanPositions{};
    std::vector<std::string> names;
    for (const ScanOutcome& scan : out_.scans) names.push_back(scan.ref.name);
    Result<ScanPositions> positions = read_positions(settings_.candidates.positions, names);
    if (!positions) {
      warn(positions.error().text());
      return {};
    }
    for (const std::string& warning : positions->warnings) warn(warning);
    return std::move(*positions);
  }

  ScanPositions stored_positions() {
    std::vector<std::pair<std::string, std::optional<Eigen::Vector3d>>> stored;
    for (const ScanOutcome& scan : out_.scans)
      if (scan.summary) stored.emplace_back(scan.ref.name, scan.summary->station_in_file);
    ScanPositions positions = positions_of_files(stored);
    if (!positions.by_name.empty())
      events_.info(fmt::format(
          "the files of {} scans store a position: near pairs are tried first (candidates.file_positions=false: not)",
          positions.by_name.size()));
    return positions;
  }

  void submit(PairOutcome& pair, std::vector<Transform> priors) {
    auto work = std::make_shared<PairWork>();
    work->outcome = &pair;
    work->priors = std::move(priors);
    work->mine = share_.has(num_submitted_++);
    const auto bytes_of = [&](int id) { return out_.scans[static_cast<std::size_t>(id)].summary->product_bytes; };
    if (work->mine) work->bytes = kBytesOfPair + kCopiesOfProduct * (bytes_of(pair.source) + bytes_of(pair.target));
    gate_.submit(work->bytes, [this, work] { pair_.try_put(work); });
  }

  void register_one(PairWork& work) {
    if (stop_) return;
    const auto start = std::chrono::steady_clock::now();
    PairOutcome& pair = *work.outcome;
    const auto error = contained([&] {
      if (!work.mine) {
        take_from_store(work);
        return;
      }
      StoredPair stored = register_planned_pair(*plan_of_.at(pair.source), *plan_of_.at(pair.target), settings_,
                                                digests_.pair, work.priors, store_, cache_);
      ++(stored.from_store ? pair.num_found : pair.num_made);
      keep(pair, std::move(stored.result), !work.priors.empty());
    });
    if (error && work.priors.empty()) pair.result.reason = error->text();
    pair.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

  void take_from_store(PairWork& work) {
    PairOutcome& pair = *work.outcome;
    const auto source = plan_of_.find(pair.source), target = plan_of_.find(pair.target);
    std::optional<PairResult> found;
    if (source != plan_of_.end() && target != plan_of_.end()) {
      found = store_.load<PairResult>(pair_key(*source->second, *target->second, digests_.pair, work.priors));
    }
    pair.missing = !found;
    if (!found) return;
    ++pair.num_found;
    keep(pair, std::move(*found), !work.priors.empty());
  }

  /// A guided result counts only where it says more than the first one did.
  static void keep(PairOutcome& pair, PairResult result, bool guided) {
    if (guided && result.verdict <= pair.result.verdict) return;
    pair.refuted.clear(), pair.confirmed.clear();
    pair.acquitted = false;
    pair.result = std::move(result);
    pair.guided = guided;
  }

  void arrive(const PairMessage& work, PairBarrier::output_ports_type& ports) {
    ::malloc_trim(0);  // what pairs leave behind in pieces would add up: a few milliseconds each
    ++pairs_done_;
    events_.advance("pairs", pairs_done_, num_pairs_);
    if (pairs_done_ == num_pairs_) std::get<0>(ports).try_put({});
    gate_.release(work->bytes);
  }

  [[nodiscard]] bool are_pairs_missing() const {
    return std::ranges::any_of(out_.pairs, [](const PairOutcome& pair) { return pair.missing; });
  }

  void solve_graph() {
    if (stop_ || are_scans_missing() || are_pairs_missing()) return;
    if (const auto error = contained([&] { solve_and_check(); })) warn(error->text());
    if (!rounds_) return;
    std::vector<PlannedPair> pairs;
    if (const auto error = contained([&] { pairs = rounds_->next(out_.solution, outlined_scans(), joins_); }))
      warn(error->text());
    submit_all(pairs);
  }

  /// A look ahead makes nothing: it knows what the store holds.
  [[nodiscard]] ModelSources model_sources() {
    return {plan_of_, store_,
            [this](int id) -> Result<ScanProduct> {
              if (share_.only_looks()) {
                looked_for_unmade_ = true;
                return tl::unexpected(Error{"not made: this is a look ahead", "", ""});
              }
              return load_product(id);
            },
            share_};
  }

  /// Solves, asks the scans on both sides of links without a loop and of ambiguous links between parts, and solves
  /// again without those they refute and with those they confirm or, in the end, acquit.
  void solve_and_check() {
    const ModelSources sources = model_sources();
    const auto check = [&](std::span<const PosedPair> pairs) { return checked(pairs, sources); };
    for (;;) {
      joins_.clear();  // they point into the solution
      out_.graph = graph_of_results();
      out_.solution = solve(out_.graph, settings_.solve);
      if (stop_) return;
      if (take_out(refuted_bridge(out_.solution, outlined_scans(), check))) continue;
      joins_ = possible_joins(out_.solution, summaries_of(outlined_scans()));
      if (take_out(refuted_joins(joins_, outlined_scans(), check))) continue;
      if (bring_in(confirmed_joins(joins_, out_.solution, outlined_scans(), check, settings_.pair.accept_probability)))
        continue;
      const auto refuted = refuted_between_parts(out_.solution, summaries_of(outlined_scans()));
      if (!bring_back(acquitted_links(refuted, check))) return;
    }
  }

  /// Every solution moves all poses a little: what was asked where a pair hardly stood elsewhere is not asked again.
  std::vector<std::optional<PoseCheck>> checked(std::span<const PosedPair> pairs, const ModelSources& sources) {
    constexpr double kElsewhereVoxels = 0.1;
    const auto moved_m = [&](const PosedPair& a, const PosedPair& b) {
      const ScanSummary& scan = *out_.scans[static_cast<std::size_t>(a.source)].summary;
      const Transform step = a.target_from_source.inverse() * b.target_from_source;
      return (step * scan.centre - scan.centre).norm() + scan.radius_m * rotation_angle_rad(step.linear());
    };
    std::vector<std::optional<PoseCheck>> answers(pairs.size());
    std::vector<PosedPair> open;
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < pairs.size(); ++k) {  // a pair may be asked at several poses at once
      const auto at = checks_.find({pairs[k].source, pairs[k].target});
      if (at != checks_.end() && moved_m(at->second.first, pairs[k]) <= kElsewhereVoxels * plan_.voxel_m)
        answers[k] = at->second.second;
      else
        open.push_back(pairs[k]), places.push_back(k);
    }
    const std::vector<std::optional<PoseCheck>> found = check_poses(open, sources, events_, stop_);
    for (std::size_t k = 0; k < open.size(); ++k) {
      answers[places[k]] = found[k];
      if (found[k]) checks_.insert_or_assign({open[k].source, open[k].target}, std::pair(open[k], *found[k]));
    }
    return answers;
  }

  /// True if any was not known to be refuted.
  bool take_out(const std::vector<RefutedLink>& all) {
    bool found = false;
    for (const RefutedLink& refuted : all) {
      const auto at = index_of_pair_.find(std::minmax(refuted.source, refuted.target));
      found = out_.pairs[at->second].refute(refuted.reason) || found;
    }
    return found;
  }

  /// True if any was not known to be confirmed.
  bool bring_in(const std::vector<ConfirmedLink>& all) {
    bool found = false;
    for (const ConfirmedLink& link : all) {
      const auto at = index_of_pair_.find(std::minmax(link.source, link.target));
      found = out_.pairs[at->second].confirm(link.reason, link.probability) || found;
    }
    return found;
  }

  /// True if any was not brought back before.
  bool bring_back(const std::vector<std::pair<int, int>>& all) {
    bool found = false;
    for (const auto& [source, target] : all) {
      const auto at = index_of_pair_.find(std::minmax(source, target));
      found = out_.pairs[at->second].acquit() || found;
    }
    return found;
  }

  [[nodiscard]] std::vector<OutlinedScan> outlined_scans() const {
    std::vector<OutlinedScan> scans;
    for (const ScanOutcome& scan : out_.scans) {
      if (scan.summary && !scan.error) scans.push_back({scan.id, &*scan.summary, scan.ref.name});
    }
    return scans;
  }

  std::size_t index_of(const PlannedPair& planned) {
    const auto [at, is_new] =
        index_of_pair_.try_emplace(std::minmax(planned.source, planned.target), out_.pairs.size());
    if (is_new) {
      PairOutcome& pair = out_.pairs.emplace_back();
      pair.source = planned.source;
      pair.target = planned.target;
      pair.score = planned.score;
    }
    PairOutcome& pair = out_.pairs[at->second];
    (planned.second_round ? pair.second_round : pair.first_round) = true;
    return at->second;
  }

  PoseGraph graph_of_results() {
    PoseGraph graph;
    graph.voxel_m = plan_.voxel_m;
    for (const ScanOutcome& scan : out_.scans) {
      if (!scan.summary || scan.error) continue;
      graph.scans.push_back({scan.id, scan.ref.name, scan.summary->centre, scan.summary->radius_m});
    }
    for (const PairOutcome& pair : out_.pairs)
      graph.links.push_back({pair.source, pair.target, pair.result, pair.guided, pair.refuted, pair.confirmed,
                             pair.confirmed_probability, ByHand::nothing, pair.first_round, pair.second_round});
    return graph;
  }

  /// For pairs whose products are not in memory: from the store, or anew if they are damaged.
  Result<ScanProduct> load_product(int id) {
    std::vector<StageTime> times;
    Result<ScanProduct> product = maker_.product(*plan_of_.at(id), times);
    const auto made = std::ranges::count(times, false, &StageTime::from_store);
    num_made_again_ += static_cast<std::size_t>(made);
    if (!product) product = tl::unexpected(by_name(product.error(), plan_of_.at(id)->ref));
    return product;
  }

  void warn(const std::string& text) {
    out_.warnings.push_back(text);
    events_.warn(text);
  }

 public:
  [[nodiscard]] std::size_t num_made_again() const { return num_made_again_; }

 private:
  const SurveyPlan& plan_;
  const Settings& settings_;
  const store::Store& store_;
  const Events& events_;
  const std::atomic<bool>& stop_;
  Share share_;
  SurveyOutcome& out_;
  ProductMaker maker_;
  SettingsDigests digests_;
  ByteGate gate_;
  ProductCache cache_;
  std::map<int, const ScanPlan*> plan_of_;
  std::map<std::pair<int, int>, std::pair<PosedPair, PoseCheck>> checks_;  // the last of each pair
  std::size_t scans_done_ = 0;                                             // written by the serial barrier only
  std::size_t pairs_done_ = 0;                                             // likewise
  std::atomic<bool> looked_for_unmade_{false};  // by a look ahead: a glance or check that the store does not hold
  std::size_t num_submitted_ = 0;               // pairs of all waves: deals them out to shares
  std::size_t num_pairs_ = 0;                   // written before pairs are submitted
  std::unique_ptr<PairRounds> rounds_;
  std::vector<PartJoin> joins_;                               // of the last solution
  std::map<std::pair<int, int>, std::size_t> index_of_pair_;  // into out_.pairs; smaller id first
  std::atomic<std::size_t> num_made_again_{0};

  flow::graph graph_;
  ScanNode read_{graph_, flow::unlimited,
                 [this](const ScanMessage& w) { return step(w, [&] { read_and_reduce(*w); }); }};
  ScanNode describe_{graph_, flow::unlimited, [this](const ScanMessage& w) { return step(w, [&] { describe(*w); }); }};
  ScanNode divide_{graph_, flow::unlimited, [this](const ScanMessage& w) { return step(w, [&] { divide(*w); }); }};
  Barrier all_scans_{graph_, flow::serial,
                     [this](const ScanMessage& w, Barrier::output_ports_type& p) { arrive(w, p); }};
  Step candidates_{graph_, flow::serial, [this](flow::continue_msg m) {
                     choose_candidates();
                     return m;
                   }};
  PairNode pair_{graph_, flow::unlimited, [this](const PairMessage& w) {
                   register_one(*w);
                   return w;
                 }};
  PairBarrier all_pairs_{graph_, flow::serial,
                         [this](const PairMessage& w, PairBarrier::output_ports_type& p) { arrive(w, p); }};
  Step solve_{graph_, flow::serial, [this](flow::continue_msg m) {
                solve_graph();
                return m;
              }};
};

void count_products(SurveyOutcome& out, std::size_t made_again) {
  out.num_made = made_again;
  for (const ScanOutcome& scan : out.scans) {
    for (const StageTime& time : scan.times) ++(time.from_store ? out.num_found : out.num_made);
  }
  for (const PairOutcome& pair : out.pairs) {
    out.num_found += pair.num_found;
    out.num_made += pair.num_made;
  }
}

}  // namespace

SurveyOutcome run_survey(const std::vector<io::ListedScan>& scans, const Settings& settings, const store::Store& store,
                         const Events& events, const std::atomic<bool>& stop, const Share& share) {
  SurveyOutcome out;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    out.scans.push_back({static_cast<int>(i), scans[i].scan, std::nullopt, std::nullopt, {}, false, {}, {}});
  }
  const auto threads = static_cast<std::size_t>(threads_of(settings.run));
  const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  oneapi::tbb::task_arena arena(static_cast<int>(threads));
  arena.execute([&] {
    out.plan = plan_survey(scans, settings, store, events, stop, share);
    const SurveyPlan& plan = out.plan;
    out.voxel_m = out.graph.voxel_m = plan.voxel_m;
    out.automatic_voxel = plan.automatic_voxel;
    for (const FailedScan& failed : plan.failed) {
      out.scans[static_cast<std::size_t>(failed.id)].error = failed.error;
      events.warn(failed.error.text());
    }
    for (const std::string& warning : plan.warnings) {
      out.warnings.push_back(warning);
      events.warn(warning);
    }
    for (const int id : plan.unseen) out.scans[static_cast<std::size_t>(id)].missing = true;
    for (const ScanPlan& scan : plan.scans) {
      ScanOutcome& outcome = out.scans[static_cast<std::size_t>(scan.id)];
      outcome.sampled = scan.sampled;
      outcome.intensity = scan.intensity;
    }
    if (plan.scans.empty() || stop) return;
    SurveyGraph graph(plan, settings, store, events, stop, share, out);
    graph.run();
    count_products(out, graph.num_made_again());
  });
  out.stopped = stop;
  out.num_missing = static_cast<std::size_t>(std::ranges::count(out.scans, true, &ScanOutcome::missing) +
                                             std::ranges::count(out.pairs, true, &PairOutcome::missing));
  std::vector<std::string> of_scans;
  for (const ScanOutcome& scan : out.scans) {
    if (scan.error) of_scans.push_back(scan.error->text());
  }
  out.warnings.insert(out.warnings.begin(), of_scans.begin(), of_scans.end());
  std::ranges::sort(out.pairs, {}, [](const PairOutcome& p) { return std::pair(p.source, p.target); });
  return out;
}

}  // namespace isthmus::pipelines
