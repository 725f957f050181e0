// Descriptors -> a bag of visual words per scan, and the likeness of two bags.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace isthmus::survey {

/// Word and weight, ascending words.
using WordBag = std::vector<std::pair<std::uint32_t, float>>;

/// One scan's descriptors.
struct DescriptorView {
  std::span<const std::uint8_t> values;  ///< num_keypoints x dimension; 255 stands for 1
  std::size_t num_keypoints = 0;
  std::span<const float> heights_voxels;  ///< of the keypoints above the station; empty if the vertical is unknown
};

/// Counts the words of every scan and weighs them: sqrt(count) x log(scans / scans that have the word), unit length. A
/// scan without descriptors, or with nothing but words that every scan has, gets an empty bag. Sums run in the given
/// order. With `use_heights` a word belongs to a height: scans whose heights are empty then have bags that say nothing.
std::vector<WordBag> weighted_bags(std::span<const DescriptorView> scans, bool use_heights);

/// Cosine of two bags, in [0, 1].
double likeness(const WordBag& a, const WordBag& b);

}  // namespace isthmus::survey
