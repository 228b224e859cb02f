// Pairs of stops to test the verdicts of matching: some that see the same walls, and some that do
// not but may be mistaken for it.
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
  geometry::Pose2 T_reference_looked;  ///< expected by a false prediction; the true pose where the
                                       ///< pair overlaps
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  ///< of a corridor, in the reference's frame
};

/// Pairs in which each stop sees at least 0.35 of the points of the other (the localizer's
/// condition for a task on a pair). Half of them at most 6 stops apart, half farther.
std::vector<StopPair> overlapping_pairs(const MatchingRun& run, std::size_t count,
                                        support::Random& random);

/// Overlapping pairs whose query shows little but walls of one direction: it looks the same some
/// metres along them.
std::vector<StopPair> corridor_pairs(const MatchingRun& run, std::size_t count,
                                     support::Random& random);

/// Pairs in which neither stop sees more than 0.05 of the points of the other, at a random false
/// pose with 0.35 of the query's points in the reference's view.
std::vector<StopPair> apart_pairs(const MatchingRun& run, std::size_t count,
                                  support::Random& random);

/// One pair for each of some stops, evenly over the log: the stop that fits best at any pose among
/// all that do not overlap with it. Candidates have the most similar distribution of distances
/// between their points.
std::vector<StopPair> look_alike_pairs(MatchingRun& run, std::size_t count);

}  // namespace topogeo::bench
