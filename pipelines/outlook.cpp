#include "pipelines/outlook.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <numeric>

#include "base/atomic_file.h"
#include "config/describe.h"
#include "pipelines/code_versions.h"
#include "pipelines/pair_stage.h"
#include "pipelines/run_job.h"
#include "pipelines/survey_pipeline.h"
#include "store/journal.h"

namespace isthmus::pipelines {
namespace {

namespace fs = std::filesystem;

// Where no run was timed: measured on one core of 2023 with scans of 0.2 to 5 million points.
constexpr double kSecondsPerScan = 3;
constexpr double kSecondsPerByte = 1 / 40e6;
constexpr double kSecondsPerPair = 4;
constexpr double kBytesOfProgram = 60e6;
constexpr double kBytesOfWork = 250e6;  // a scan or pair in work, where nothing better is known

/// What the last finished run of an output was made with.
struct LastRun {
  bool known = false;
  double voxel_m = 0;
  std::string code;
  YAML::Node settings;
};

LastRun last_run_of(const fs::path& output) {
  LastRun last;
  const Result<std::string> text = read_file(output / "run.json");
  if (!text) return last;
  try {
    const YAML::Node json = YAML::Load(*text);  // JSON is YAML
    last.voxel_m = json["voxel_m"].as<double>();
    last.code = json["versions"]["code"].as<std::string>();
    last.settings = YAML::Load(json["settings"].as<std::string>());
    last.known = true;
  } catch (const YAML::Exception&) {
    last.known = false;  // of another version, or damaged: nothing to compare with
  }
  return last;
}

std::string text_of(const YAML::Node& node) {
  return node.IsDefined() ? fmt::format("{}", YAML::Dump(node)) : std::string("unset");
}

/// "pair.max_seeds is 100 instead of 300", for every setting of the stages that differs.
std::vector<std::string> changes(const LastRun& last, const YAML::Node& now, const std::vector<std::string>& stages) {
  std::vector<std::string> out;
  if (!last.known) return out;
  for (const std::string& stage : stages) {
    for (const auto& entry : now[stage]) {
      const std::string key = entry.first.as<std::string>();
      const YAML::Node old = last.settings[stage] ? last.settings[stage][key] : YAML::Node(YAML::NodeType::Undefined);
      const std::string before = text_of(old), after = text_of(entry.second);
      if (before != after) out.push_back(fmt::format("{}.{} is {} instead of {}", stage, key, after, before));
    }
  }
  return out;
}

class Reasons {
 public:
  Reasons(const Job& job, double voxel_m) : last_(last_run_of(job.output)), voxel_m_(voxel_m) {
    Settings settings = job.settings;
    now_ = YAML::Load(config::values_yaml(settings.stages()));
  }
  /// Why a product of a scan whose content is known is not there, the last stages of which are `stages`.
  [[nodiscard]] std::string why(const std::vector<std::string>& stages) const {
    if (!last_.known) return "not computed yet";
    std::vector<std::string> found = changes(last_, now_, stages);
    if (last_.voxel_m != voxel_m_ && found.empty()) {
      found.push_back(fmt::format("the voxel is {} m instead of {} m", voxel_m_, last_.voxel_m));
    }
    if (found.empty() && last_.code != kPairVersion) found.emplace_back("another version of the program");
    if (found.empty()) found.emplace_back("not computed yet, or no longer kept");
    return fmt::format("{}", fmt::join(found, ", "));
  }

 private:
  LastRun last_;
  double voxel_m_;
  YAML::Node now_;
};

void add(std::vector<OutlookGroup>& groups, const std::string& why, std::string item) {
  auto group = std::ranges::find(groups, why, &OutlookGroup::why);
  if (group == groups.end()) group = groups.insert(groups.end(), {why, {}});
  group->items.push_back(std::move(item));
}

/// Mean seconds by stage from all journals of the output.
struct Times {
  std::map<std::string, std::pair<double, std::size_t>> of_stage;
  [[nodiscard]] double mean(const std::string& stage) const {
    const auto found = of_stage.find(stage);
    return found == of_stage.end() ? 0 : found->second.first / static_cast<double>(found->second.second);
  }
  [[nodiscard]] std::size_t count(const std::string& stage) const {
    const auto found = of_stage.find(stage);
    return found == of_stage.end() ? 0 : found->second.second;
  }
};

Times times_of(const fs::path& output) {
  Times times;
  for (const store::ProcessJournal& journal : store::read_journals(output / "journal")) {
    for (const store::JournalLine& line : journal.lines) {
      if (line.event != "made") continue;
      auto& [seconds, count] = times.of_stage[line.stage];
      seconds += line.seconds;
      ++count;
    }
  }
  return times;
}

/// What describing the scans and describing their pairs costs.
void expect_cost(const Job& job, const std::vector<const ScanPlan*>& plans, std::uint64_t file_bytes, Outlook& out) {
  const Times times = times_of(job.output);
  const double threads = threads_of(job.settings.run);
  double of_scan = times.mean("sampled") + times.mean("features") + times.mean("regions");
  double of_pair = times.mean("pair");
  out.timed_items = times.count("sampled") + times.count("pair");
  const auto scans = static_cast<double>(out.scans_to_make);
  double seconds = of_scan * scans;
  if (times.count("sampled") == 0)
    seconds = scans * kSecondsPerScan + static_cast<double>(file_bytes) * kSecondsPerByte;
  if (times.count("pair") == 0) of_pair = kSecondsPerPair;
  out.seconds = (seconds + of_pair * static_cast<double>(out.pairs_to_make)) / threads;
  if (out.scans_to_make + out.pairs_to_make == 0) return;
  std::vector<double> bytes;
  for (const ScanPlan* plan : plans) bytes.push_back(static_cast<double>(plan->bytes));
  for (std::size_t i = 0; i < out.pairs_to_make + out.scans_to_make - plans.size(); ++i) bytes.push_back(kBytesOfWork);
  std::ranges::sort(bytes, std::ranges::greater());
  bytes.resize(std::min(bytes.size(), static_cast<std::size_t>(2 * threads)));
  const double in_flight = std::accumulate(bytes.begin(), bytes.end(), 0.0);
  out.most_bytes = kBytesOfProgram + std::min(in_flight, static_cast<double>(memory_bytes_of(job.settings.run)));
}

void look_at_scans(const SurveyPlan& plan, const std::vector<io::ListedScan>& scans, const store::Store& store,
                   const Reasons& reasons, Outlook& out, std::vector<const ScanPlan*>& to_make) {
  for (const int id : plan.unseen) add(out.scans, "new or changed file", scans[static_cast<std::size_t>(id)].scan.name);
  for (const ScanPlan& scan : plan.scans) {
    if (store.contains(scan.summary)) continue;
    to_make.push_back(&scan);
    const bool sampled = store.contains(scan.sampled), features = store.contains(scan.features);
    const std::vector<std::string> stages = features  ? std::vector<std::string>{"regions"}
                                            : sampled ? std::vector<std::string>{"features"}
                                                      : std::vector<std::string>{"sampling"};
    add(out.scans, reasons.why(stages), scan.ref.name);
  }
  out.scans_to_make = plan.unseen.size() + to_make.size();
  out.scans_found = plan.scans.size() - to_make.size();
  out.scans_failed = plan.failed.size();
  for (const FailedScan& failed : plan.failed) out.warnings.push_back(failed.error.text());
}

void look_at_pairs(const SurveyOutcome& survey, const Reasons& reasons, Outlook& out) {
  const auto scan = [&](int id) -> const ScanOutcome& { return survey.scans[static_cast<std::size_t>(id)]; };
  for (const PairOutcome& pair : survey.pairs) {
    if (!pair.missing) {
      ++out.pairs_found;
      continue;
    }
    ++out.pairs_to_make;
    const bool new_scan = scan(pair.source).missing || scan(pair.target).missing;
    add(out.pairs, new_scan ? "one of the scans is to be computed" : reasons.why({"pair"}),
        scan(pair.source).ref.name + " with " + scan(pair.target).ref.name);
  }
}

/// Of the first round, where candidates follow from descriptors that are not there yet.
std::size_t most_pairs(std::size_t scans, const CandidateOptions& options) {
  const std::size_t all = scans * (scans - 1) / 2;
  return std::min(all, scans * static_cast<std::size_t>(options.pairs_per_scan));
}

void look(const Job& job, const std::vector<io::ListedScan>& scans, const store::Store& store, Outlook& out) {
  const std::atomic<bool> never_stop{false};
  const SurveyOutcome survey = run_survey(scans, job.settings, store, {}, never_stop, Share::nothing());
  const SurveyPlan& plan = survey.plan;
  out.num_scans = scans.size();
  out.voxel_m = plan.voxel_m;
  const Reasons reasons(job, plan.voxel_m);
  std::vector<const ScanPlan*> to_make;
  look_at_scans(plan, scans, store, reasons, out, to_make);
  const bool all_pairs = out.num_scans <= static_cast<std::size_t>(job.settings.candidates.all_pairs_up_to);
  out.pairs_are_known = out.scans_to_make == 0 || (all_pairs && out.scans_found > 0);
  if (out.pairs_are_known) {
    look_at_pairs(survey, reasons, out);
  } else if (out.num_scans > out.scans_failed) {
    const std::size_t usable = out.num_scans - out.scans_failed;
    out.pairs_to_make = all_pairs ? usable * (usable - 1) / 2 : most_pairs(usable, job.settings.candidates);
  }
  out.pairs_are_guessed = out.pairs_are_known && survey.guessed;
  out.is_complete = out.scans_to_make == 0 && out.pairs_to_make == 0 && !survey.guessed;
  std::uint64_t file_bytes = 0;
  for (const int id : plan.unseen) {
    std::error_code error;
    const auto bytes = fs::file_size(scans[static_cast<std::size_t>(id)].scan.path, error);
    if (!error) file_bytes += bytes;
  }
  expect_cost(job, to_make, file_bytes, out);
}

}  // namespace

Result<Outlook> look_ahead(const Job& job) {
  Result<io::ScanListing> listing = scans_of_job(job);
  if (!listing) return tl::unexpected(listing.error());
  Outlook out;
  std::error_code error;
  Result<store::Store> store = store::Store::none();
  if (fs::is_directory(store_folder(job), error)) store = store::Store::open(store_folder(job), {});
  if (!store) return tl::unexpected(store.error());
  look(job, listing->scans, *store, out);
  return out;
}

}  // namespace isthmus::pipelines
