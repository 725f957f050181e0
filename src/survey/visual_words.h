// Descriptors -> a bag of visual words per scan, and the likeness of two bags.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace isthmus::survey {

/// Word and weight, ascending words.
using WordBag = std::vector<std::pair<std::uint32_t, float>>;

/// One scan's descriptors, num_keypoints x dimension.
struct DescriptorView {
  std::span<const float> values;
  std::size_t num_keypoints = 0;
};

/// Counts the words of every scan and weighs them: sqrt(count) x log(scans / scans that have the word), unit length. A
/// scan without descriptors, or with nothing but words that every scan has, gets an empty bag. Sums run in the given
/// order.
std::vector<WordBag> weighted_bags(std::span<const DescriptorView> scans);

/// Cosine of two bags, in [0, 1].
double likeness(const WordBag& a, const WordBag& b);

}  // namespace isthmus::survey
