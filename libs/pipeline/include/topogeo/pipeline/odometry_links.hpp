// The steps of a map that no match measures: their poses rest on odometry alone.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/storage/map_document.hpp"

namespace topogeo::pipeline {

/// Consecutive steps from stop to stop without a match across them.
struct OdometryStretch {
  std::uint32_t first_id = 0;  ///< local map ids; the stretch begins and ends at these stops
  std::uint32_t last_id = 0;
  double length_m = 0.0;  ///< by odometry
  double off_m = 0.0;     ///< two standard deviations of the position at its end, seen from its
                          ///< start, over both directions, by the stated noise of odometry
  double off_rad = 0.0;   ///< the same for the heading
  /// Whether a loop joins stops before and after each of its steps, which limits the error.
  bool held_by_loop = false;

  [[nodiscard]] std::uint32_t steps() const { return last_id - first_id; }
};

/// The stretches of a map, in the order of the path. A match across a step joins a stop before it
/// with one after it; only matches with a recent stop count, because a loop tells little about one
/// step. Empty for a map without edges, whose measurements are unknown. The first step of a later
/// drive is no step. Edges between unknown stops are ignored.
std::vector<OdometryStretch> odometry_stretches(const storage::MapDocument& document);

}  // namespace topogeo::pipeline
