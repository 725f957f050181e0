#include "survey/visual_words.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rng.h"

namespace isthmus::survey {
namespace {

// Several independent short codes instead of one long one: a descriptor near a plane of one table is far from those of
// others.
constexpr std::uint32_t kTables = 8;
constexpr std::uint32_t kBits = 9;
constexpr std::uint32_t kHeightBits = 7;
constexpr float kHeightBinVoxels = 4;
constexpr std::uint32_t kNumWords = kTables << (kHeightBits + kBits);
constexpr std::uint64_t kSeed = 0x15AA5;  // any number; fixed, so that words mean the same in every run

/// Random planes through the mean descriptor: without it the all-positive histograms would lie on one side of most
/// planes.
struct Planes {
  std::vector<float> normals;  // (kTables x kBits) x dimension
  std::vector<float> offsets;  // of the mean descriptor along them
};

std::vector<double> mean_descriptor(std::span<const DescriptorView> scans, std::size_t dimension) {
  std::vector<double> mean(dimension, 0.0);
  double count = 0;
  for (const DescriptorView& scan : scans) {
    std::vector<std::uint64_t> sum(dimension, 0);
    for (std::size_t i = 0; i < scan.num_keypoints; ++i)
      for (std::size_t d = 0; d < dimension; ++d) sum[d] += scan.values[i * dimension + d];
    for (std::size_t d = 0; d < dimension; ++d) mean[d] += static_cast<double>(sum[d]);
    count += static_cast<double>(scan.num_keypoints);
  }
  for (double& value : mean) value /= std::max(1.0, count);
  return mean;
}

Planes planes_for(std::span<const DescriptorView> scans, std::size_t dimension) {
  const std::vector<double> mean = mean_descriptor(scans, dimension);
  Planes planes;
  Rng rng(seed_of(kSeed, "visual words"));
  for (std::uint32_t plane = 0; plane < kTables * kBits; ++plane) {
    double offset = 0;
    for (std::size_t d = 0; d < dimension; ++d) {
      planes.normals.push_back(static_cast<float>(rng.normal()));
      offset += static_cast<double>(planes.normals.back()) * mean[d];
    }
    planes.offsets.push_back(static_cast<float>(offset));
  }
  return planes;
}

std::uint32_t height_bin(float height_voxels) {
  constexpr float kMost = static_cast<float>(1U << (kHeightBits - 1));
  return static_cast<std::uint32_t>(std::clamp(std::floor(height_voxels / kHeightBinVoxels), -kMost, kMost - 1) +
                                    kMost);
}

/// Words and how often the scan has them, ascending.
WordBag word_counts(const DescriptorView& scan, std::size_t dimension, const Planes& planes, bool use_heights) {
  std::vector<std::uint32_t> words;
  if (use_heights && scan.heights_voxels.empty()) return {};
  words.reserve(scan.num_keypoints * kTables);
  std::vector<float> values(dimension);
  for (std::size_t i = 0; i < scan.num_keypoints; ++i) {
    for (std::size_t d = 0; d < dimension; ++d) values[d] = static_cast<float>(scan.values[i * dimension + d]);
    const std::uint32_t height = use_heights ? height_bin(scan.heights_voxels[i]) : 0;
    const float* normal = planes.normals.data();
    for (std::uint32_t table = 0; table < kTables; ++table) {
      std::uint32_t word = (table << kHeightBits | height) << kBits;
      for (std::uint32_t bit = 0; bit < kBits; ++bit, normal += dimension) {
        float along = 0;
        for (std::size_t d = 0; d < dimension; ++d) along += values[d] * normal[d];
        word |= static_cast<std::uint32_t>(along > planes.offsets[table * kBits + bit]) << bit;
      }
      words.push_back(word);
    }
  }
  std::sort(words.begin(), words.end());
  WordBag counts;
  for (const std::uint32_t word : words) {
    if (counts.empty() || counts.back().first != word) counts.emplace_back(word, 0.0F);
    counts.back().second += 1;
  }
  return counts;
}

WordBag weighted(const WordBag& counts, const std::vector<std::uint32_t>& scans_with_word, std::size_t num_scans) {
  WordBag bag;
  double sq_norm = 0;
  for (const auto& [word, count] : counts) {
    const double rarity = std::log(static_cast<double>(num_scans) / scans_with_word[word]);
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

std::vector<WordBag> weighted_bags(std::span<const DescriptorView> scans, bool use_heights) {
  std::size_t dimension = 0;
  for (const DescriptorView& scan : scans)
    if (scan.num_keypoints > 0) dimension = scan.values.size() / scan.num_keypoints;
  std::vector<WordBag> bags(scans.size());
  if (dimension == 0) return bags;
  const Planes planes = planes_for(scans, dimension);
  parallel_for_index(scans.size(), 1,
                     [&](std::size_t i) { bags[i] = word_counts(scans[i], dimension, planes, use_heights); });
  std::vector<std::uint32_t> scans_with_word(kNumWords, 0);
  for (const WordBag& counts : bags)
    for (const auto& [word, count] : counts) ++scans_with_word[word];
  parallel_for_index(scans.size(), 1,
                     [&](std::size_t i) { bags[i] = weighted(bags[i], scans_with_word, scans.size()); });
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
