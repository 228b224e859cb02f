// Pairs of stops to try the verdicts of matching on: some that see the same walls, and some that do
// not but might be taken to.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "topogeo/support/random.hpp"

#include "matching_run.hpp"

namespace topogeo::bench {

struct StopPair {
  std::size_t reference = 0;
  std::size_t query = 0;
  geometry::Pose2 T_reference_query;   ///< true
  geometry::Pose2 T_reference_looked;  ///< what a false prediction speaks of; where the pair
                                       ///< overlaps the true pose
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< of a corridor, in the reference's frame
};

/// Pairs of which either sees at least 0.35 of the points of the other (what the localizer asks of
/// a pair before it spends a task on it). Half of them at most 6 stops apart, half farther.
std::vector<StopPair> overlapping_pairs(const MatchingRun& run, std::size_t count,
                                        support::Random& random);

/// Overlapping pairs of which the query shows little but walls of one direction: it looks the same
/// some metres along them.
std::vector<StopPair> corridor_pairs(const MatchingRun& run, std::size_t count,
                                     support::Random& random);

/// Pairs of which neither sees more than 0.05 of the points of the other, at a random false pose at
/// which the reference would have 0.35 of the query's points in view.
std::vector<StopPair> apart_pairs(const MatchingRun& run, std::size_t count,
                                  support::Random& random);

/// For stops evenly over the log: of all that it forms such a pair with, the one that fits best
/// when laid on it at any pose. Candidates are those whose points have the most similar
/// distribution of distances to each other.
std::vector<StopPair> look_alike_pairs(MatchingRun& run, std::size_t count);

}  // namespace topogeo::bench
