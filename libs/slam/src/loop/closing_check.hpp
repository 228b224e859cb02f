// Checks whether a closed loop fits the steps along it: the search of loop_search.hpp with the
// match that closes the loop as its only candidate.
#pragma once

#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

#include "loop/loop_search.hpp"
#include "loop/relative_solution.hpp"

namespace topogeo::localization {

/// One step along a loop: where a pose lies relative to the one before it. Best first.
using LoopStep = std::vector<RelativeSolution>;

struct ClosingCheck {
  bool consistent = false;      ///< poses along the loop exist that fit the match
  double summed_fitness = 0.0;  ///< of the best poses, match and steps; 0 without any
  double best_fitness = 0.0;    ///< the sum if every best solution held unchanged
  LoopSearchOutcome outcome = LoopSearchOutcome::kNoCandidates;
  std::vector<geometry::Pose2> T_first_pose;  ///< of the best poses, from the identity on
};

/// Whether a match of the last pose of a chain with its first one (`closing`, T_first_last) fits
/// the steps between them. The chain need not follow time: any path through a pose graph will do.
/// The uncertainty of a pose is that of the best solutions before it, widened to cover the others
/// where a step has several. Throws std::invalid_argument like search_loop(), and for a step
/// without a solution or with a fitness outside [0, 1].
ClosingCheck check_closing(std::span<const LoopStep> steps, const RelativeSolution& closing,
                           const LoopSearchConfig& config = {});

}  // namespace topogeo::localization
