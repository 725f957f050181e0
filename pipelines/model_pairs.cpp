#include "pipelines/model_pairs.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "base/parallel.h"
#include "pairwise/screen_pair.h"
#include "pipelines/code_versions.h"

namespace isthmus::pipelines {
namespace {

constexpr std::size_t kBlock = 8;  // scans; two blocks are in memory, about 10 MB a scan

struct LoadedScan {
  ScanProduct product;
  std::unique_ptr<ScanModel> model;
};
using Block = std::map<int, std::unique_ptr<LoadedScan>>;  // by id; nothing where the product cannot be had

/// One kind of look: how the store names it and what it is made of, beside the two scans' regions.
template <class Answer>
struct Look {
  std::string name;      ///< of the artifact
  std::string progress;  ///< of the stage, for events
  std::function<std::string(std::size_t k)> inputs;
  std::function<Answer(std::size_t k, const ScanModel& source, const ScanModel& target)> make;
};

template <class Answer>
class Looking {
 public:
  Looking(std::vector<std::pair<int, int>> pairs, Look<Answer> look, const ModelSources& sources, const Events& events,
          const std::atomic<bool>& stop)
      : pairs_(std::move(pairs)),
        look_(std::move(look)),
        sources_(sources),
        events_(events),
        stop_(stop),
        answers_(pairs_.size()) {}

  std::vector<std::optional<Answer>> run() {
    const std::vector<std::size_t> open = look_up();
    std::set<int> ids;
    for (const std::size_t k : open) ids.insert({pairs_[k].first, pairs_[k].second});
    std::map<int, std::size_t> block_of;
    for (const int id : ids) block_of.emplace(id, block_of.size() / kBlock);
    std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> work;
    for (const std::size_t k : open)
      work[std::minmax(block_of.at(pairs_[k].first), block_of.at(pairs_[k].second))].push_back(k);
    std::vector<std::pair<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>>> units(work.begin(),
                                                                                                work.end());
    begin_at_own_part(units);
    std::size_t row_number = 0;
    Block row;  // stays while the other block of the pairs changes
    for (auto& [blocks, of_blocks] : units) {
      if (stop_) break;
      const std::size_t num_of_blocks = of_blocks.size();
      take_from_others(of_blocks);
      begin_at_own_part(of_blocks);
      if (row_number != blocks.first) row.clear();
      row_number = blocks.first;
      Block column;
      load(of_blocks, block_of, blocks.first, row);
      load(of_blocks, block_of, blocks.second, blocks.second == blocks.first ? row : column);
      parallel_for_index(of_blocks.size(), 1, [&](std::size_t k) {
        if (!stop_) look_at(of_blocks[k], row, column);
      });
      done_ += num_of_blocks;
      events_.advance(look_.progress, done_, pairs_.size());
    }
    return std::move(answers_);
  }

 private:
  [[nodiscard]] store::Key key_of(std::size_t k) const {
    const std::array<std::string, 3> inputs = {sources_.plans.at(pairs_[k].first)->regions.digest,
                                               sources_.plans.at(pairs_[k].second)->regions.digest, look_.inputs(k)};
    return store::make_key(look_.name, kPairVersion, inputs);
  }

  /// Fills in what the store has; the rest, ascending.
  std::vector<std::size_t> look_up() {
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      answers_[k] = sources_.store.template load<Answer>(key_of(k));
      if (!answers_[k]) {
        open.push_back(k);
      }
    }
    done_ = pairs_.size() - open.size();
    return open;
  }

  /// Moves the share's part of the items to the front; the others follow in turn.
  template <class Item>
  void begin_at_own_part(std::vector<Item>& items) const {
    const Share& share = sources_.share;
    if (share.count < 2) return;
    const std::size_t first = items.size() * share.index / share.count;
    std::rotate(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(first), items.end());
  }

  /// What other processes made since look_up() needs no scans in memory.
  void take_from_others(std::vector<std::size_t>& work) {
    if (sources_.share.count < 2) return;
    std::erase_if(work, [&](std::size_t k) {
      answers_[k] = sources_.store.template load<Answer>(key_of(k));
      return answers_[k].has_value();
    });
  }

  void load(const std::vector<std::size_t>& work, const std::map<int, std::size_t>& block_of, std::size_t block,
            Block& into) {
    std::set<int> missing;
    for (const std::size_t k : work)
      for (const int id : {pairs_[k].first, pairs_[k].second})
        if (block_of.at(id) == block && !into.contains(id)) missing.insert(id);
    const std::vector<int> ids(missing.begin(), missing.end());
    std::vector<std::unique_ptr<LoadedScan>> loaded(ids.size());
    parallel_for_index(ids.size(), 1, [&](std::size_t k) {
      Result<ScanProduct> product = sources_.load(ids[k]);
      if (!product) return;
      auto scan = std::make_unique<LoadedScan>();
      scan->product = std::move(*product);
      scan->product.sampled.fine = {};
      scan->model = std::make_unique<ScanModel>(scan->product.sampled, scan->product.features, scan->product.regions,
                                                ModelLevel::coarse);
      loaded[k] = std::move(scan);
    });
    for (std::size_t k = 0; k < ids.size(); ++k) into[ids[k]] = std::move(loaded[k]);
  }

  void look_at(std::size_t k, const Block& row, const Block& column) {
    const auto find = [&](int id) -> const LoadedScan* {
      const auto in_row = row.find(id);
      if (in_row != row.end()) return in_row->second.get();
      const auto in_column = column.find(id);
      return in_column != column.end() ? in_column->second.get() : nullptr;
    };
    const LoadedScan *source = find(pairs_[k].first), *target = find(pairs_[k].second);
    if (source == nullptr || target == nullptr) return;
    if (sources_.share.count > 1) answers_[k] = sources_.store.template load<Answer>(key_of(k));
    if (answers_[k]) return;
    answers_[k] = look_.make(k, *source->model, *target->model);
    sources_.store.keep(key_of(k), *answers_[k]);
  }

  std::vector<std::pair<int, int>> pairs_;
  Look<Answer> look_;
  const ModelSources& sources_;
  const Events& events_;
  const std::atomic<bool>& stop_;
  std::vector<std::optional<Answer>> answers_;
  std::size_t done_ = 0;
};

}  // namespace

std::vector<ScreenedPair> screen_pairs(std::span<const std::pair<int, int>> pairs, const ModelSources& sources,
                                       const Events& events, const std::atomic<bool>& stop) {
  using Glance = std::optional<double>;
  const Look<Glance> look{
      "glance", "glances", [](std::size_t) { return std::string(); },
      [](std::size_t, const ScanModel& source, const ScanModel& target) { return screen_pair(source, target); }};
  const auto glances = Looking<Glance>({pairs.begin(), pairs.end()}, look, sources, events, stop).run();
  std::vector<ScreenedPair> out;
  for (std::size_t k = 0; k < pairs.size(); ++k)
    if (glances[k] && *glances[k]) out.push_back({pairs[k].first, pairs[k].second, **glances[k]});
  return out;
}

std::vector<std::optional<PoseCheck>> check_poses(std::span<const PosedPair> pairs, const ModelSources& sources,
                                                  const Events& events, const std::atomic<bool>& stop) {
  std::vector<std::pair<int, int>> ids;
  for (const PosedPair& pair : pairs) ids.emplace_back(pair.source, pair.target);
  const Look<PoseCheck> look{"check", "checks of poses",
                             [&](std::size_t k) { return store::to_bytes(pairs[k].target_from_source); },
                             [&](std::size_t k, const ScanModel& source, const ScanModel& target) {
                               return check_pose(source, target, pairs[k].target_from_source);
                             }};
  return Looking<PoseCheck>(std::move(ids), look, sources, events, stop).run();
}

std::vector<float> compare_plans(std::span<const std::pair<int, int>> pairs,
                                 const std::function<float(std::size_t)>& compare, const ModelSources& sources,
                                 const Events& events, const std::atomic<bool>& stop) {
  std::vector<std::string> inputs;
  for (const auto& [source, target] : pairs)
    for (const int id : {source, target}) {
      const auto plan = sources.plans.find(id);
      inputs.push_back(plan != sources.plans.end() ? plan->second->summary.digest : std::string());
    }
  constexpr const char* kRule = "-1";  // of survey/candidates.cpp, which no digest covers: plans whose up is unknown
  const store::Key key = store::make_key("plan_likeness", std::string(kRegionsVersion) + kRule, inputs);
  if (auto known = sources.store.load<std::vector<float>>(key); known && known->size() == pairs.size()) return *known;
  std::vector<float> answers(pairs.size(), 0.0F);
  constexpr std::size_t kBetweenNews = 256;
  for (std::size_t first = 0; first < pairs.size() && !stop; first += kBetweenNews) {
    const std::size_t count = std::min(kBetweenNews, pairs.size() - first);
    parallel_for_index(count, 1, [&](std::size_t k) { answers[first + k] = compare(first + k); });
    events.advance("ground plans", first + count, pairs.size());
  }
  if (!stop && !sources.share.only_looks()) sources.store.keep(key, answers);
  return answers;
}

}  // namespace isthmus::pipelines
