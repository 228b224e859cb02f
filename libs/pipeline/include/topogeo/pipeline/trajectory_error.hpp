// How far a trajectory is from the truth, as shared tools of this field measure it: poses paired by
// time, then the best rigid alignment, then what is left over.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::pipeline {

struct TrajectoryError {
  std::size_t pairs = 0;     ///< poses compared
  double rms_m = 0.0;        ///< root of the mean squared distance after alignment
  double largest_m = 0.0;    ///< largest such distance
  double heading_rad = 0.0;  ///< mean absolute difference of headings after alignment
};

/// Pairs each pose of `truth` with the pose of `estimate` nearest in time, if they are at most
/// `max_apart_ns` apart, and turns and shifts the estimate (no scaling) so that the squared
/// distances are least. Both in time order, each in a frame of its own. Throws
/// std::invalid_argument when fewer than three poses pair.
TrajectoryError trajectory_error(std::span<const topomap::StampedPose> estimate,
                                 std::span<const topomap::StampedPose> truth,
                                 std::int64_t max_apart_ns = 50'000'000);

}  // namespace topogeo::pipeline
