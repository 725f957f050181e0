#include "survey/visual_words.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "base/rng.h"

namespace isthmus::survey {
namespace {

// Several independent short codes instead of one long one: a descriptor near a plane of one table is far from those of
// others.
constexpr int kTables = 4;
constexpr int kBits = 11;
constexpr std::uint64_t kSeed = 0x15AA5;  // any number; fixed, so that words mean the same in every run

/// Random planes through the mean descriptor: without it the all-positive histograms would lie on one side of most
/// planes.
struct Planes {
  std::vector<float> mean;     // dimension
  std::vector<float> normals;  // (kTables x kBits) x dimension
};

std::vector<float> mean_descriptor(std::span<const DescriptorView> scans, std::size_t dimension) {
  std::vector<double> sum(dimension, 0.0);
  double count = 0;
  for (const DescriptorView& scan : scans) {
    for (std::size_t i = 0; i < scan.num_keypoints; ++i)
      for (std::size_t d = 0; d < dimension; ++d) sum[d] += scan.values[i * dimension + d];
    count += static_cast<double>(scan.num_keypoints);
  }
  std::vector<float> mean(dimension);
  for (std::size_t d = 0; d < dimension; ++d) mean[d] = static_cast<float>(sum[d] / std::max(1.0, count));
  return mean;
}

Planes planes_for(std::span<const DescriptorView> scans, std::size_t dimension) {
  Planes planes{mean_descriptor(scans, dimension), {}};
  Rng rng(seed_of(kSeed, "visual words"));
  planes.normals.resize(static_cast<std::size_t>(kTables * kBits) * dimension);
  for (float& value : planes.normals) value = static_cast<float>(rng.normal());
  return planes;
}

std::map<std::uint32_t, float> word_counts(const DescriptorView& scan, std::size_t dimension, const Planes& planes) {
  std::map<std::uint32_t, float> counts;
  std::vector<float> centred(dimension);
  for (std::size_t i = 0; i < scan.num_keypoints; ++i) {
    for (std::size_t d = 0; d < dimension; ++d) centred[d] = scan.values[i * dimension + d] - planes.mean[d];
    const float* normal = planes.normals.data();
    for (int table = 0; table < kTables; ++table) {
      std::uint32_t word = static_cast<std::uint32_t>(table) << kBits;
      for (int bit = 0; bit < kBits; ++bit, normal += dimension) {
        float side = 0;
        for (std::size_t d = 0; d < dimension; ++d) side += centred[d] * normal[d];
        word |= static_cast<std::uint32_t>(side > 0) << bit;
      }
      counts[word] += 1.0F;
    }
  }
  return counts;
}

WordBag weighted(const std::map<std::uint32_t, float>& counts, const std::map<std::uint32_t, int>& scans_with_word,
                 std::size_t num_scans) {
  WordBag bag;
  double sq_norm = 0;
  for (const auto& [word, count] : counts) {
    const double rarity = std::log(static_cast<double>(num_scans) / scans_with_word.at(word));
    // The square root tames bursts: a wall gives one word a thousand times.
    const double weight = std::sqrt(static_cast<double>(count)) * rarity;
    if (weight <= 0) continue;
    bag.emplace_back(word, static_cast<float>(weight));
    sq_norm += weight * weight;
  }
  for (auto& [word, weight] : bag) weight = static_cast<float>(weight / std::sqrt(sq_norm));
  return bag;
}

}  // namespace

std::vector<WordBag> weighted_bags(std::span<const DescriptorView> scans) {
  std::size_t dimension = 0;
  for (const DescriptorView& scan : scans)
    if (scan.num_keypoints > 0) dimension = scan.values.size() / scan.num_keypoints;
  std::vector<WordBag> bags(scans.size());
  if (dimension == 0) return bags;
  const Planes planes = planes_for(scans, dimension);
  std::vector<std::map<std::uint32_t, float>> counts(scans.size());
  parallel_for_index(scans.size(), 1, [&](std::size_t i) { counts[i] = word_counts(scans[i], dimension, planes); });
  std::map<std::uint32_t, int> scans_with_word;
  for (const auto& scan : counts)
    for (const auto& [word, count] : scan) ++scans_with_word[word];
  parallel_for_index(scans.size(), 1,
                     [&](std::size_t i) { bags[i] = weighted(counts[i], scans_with_word, scans.size()); });
  return bags;
}

double likeness(const WordBag& a, const WordBag& b) {
  double sum = 0;
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].first < b[j].first)
      ++i;
    else if (b[j].first < a[i].first)
      ++j;
    else
      sum += static_cast<double>(a[i++].second) * b[j++].second;
  }
  return std::clamp(sum, 0.0, 1.0);
}

}  // namespace isthmus::survey
