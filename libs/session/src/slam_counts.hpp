// Sums of the counts of several SLAM algorithms.
#pragma once

#include <cstddef>

#include "topogeo/slam/slam.hpp"

namespace topogeo::localization {

inline void add_counts(SlamCounts& sum, const SlamCounts& more) {
  sum.tasks += more.tasks;
  sum.evaluations += more.evaluations;
  for (std::size_t i = 0; i < kReasons; ++i) sum.reasons[i] += more.reasons[i];
  sum.steps_in_doubt += more.steps_in_doubt;
  sum.unconfirmed_loops += more.unconfirmed_loops;
  sum.optimizations += more.optimizations;
  sum.failed_optimizations += more.failed_optimizations;
  sum.removed_loops += more.removed_loops;
}

}  // namespace topogeo::localization
