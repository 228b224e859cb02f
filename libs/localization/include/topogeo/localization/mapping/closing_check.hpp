// Whether a closed loop fits the steps along it, by the search of loop_search.hpp with the match
// that closes the loop as its one candidate.
#pragma once

#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/loop_search.hpp"
#include "topogeo/localization/mapping/relative_solution.hpp"

namespace topogeo::localization {

/// One step along a loop: where a pose lies relative to the one before it. Best first.
using LoopStep = std::vector<RelativeSolution>;

struct ClosingCheck {
  bool consistent = false;      ///< poses along the loop exist that fit the match
  double summed_fitness = 0.0;  ///< of the best of them, match and steps; 0 without one
  double best_fitness = 0.0;    ///< what the sum would be if every best solution held as it is
  LoopSearchOutcome outcome = LoopSearchOutcome::kNoCandidates;
  std::vector<geometry::Pose2> T_first_pose;  ///< of the best, from the identity on
};

/// Whether a match of the last pose of a chain with its first one (`closing`, T_first_last) fits
/// the steps between. The chain need not follow time: any path through a pose graph will do. The
/// uncertainty of a pose is that of the best solutions before it, wide enough for the others where
/// there are several. Throws std::invalid_argument like search_loop(), and for a step without a
/// solution or with a fitness outside of [0, 1].
ClosingCheck check_closing(std::span<const LoopStep> steps, const RelativeSolution& closing,
                           const LoopSearchConfig& config = {});

}  // namespace topogeo::localization
