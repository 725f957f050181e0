// Settings of the tests of this folder.
#pragma once

#include "pairwise/register_pair.h"

namespace isthmus::testing {

/// No generator, no congruent sets: only priors are judged.
inline PairOptions no_search() {
  PairOptions options;
  options.generators.clear();
  options.congruent_hypotheses = 0;
  return options;
}

}  // namespace isthmus::testing
