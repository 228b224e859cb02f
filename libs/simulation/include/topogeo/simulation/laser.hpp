// A simulated laser: exact ranges by ray casting, then the noise of a SICK PLS.
#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// Directions of the beams in the laser frame. The default is the PLS: 361 beams over 180 degrees.
struct BeamPattern {
  double angle_min_rad = -std::numbers::pi / 2.0;
  double angle_step_rad = std::numbers::pi / 360.0;
  std::size_t count = 361;
  double range_max_m = 49.9;  ///< surfaces at this distance or beyond give no return
};

/// Exact distance along each beam to the first surface, metres; infinity if no surface is nearer
/// than range_max_m. A beam that grazes the end of a segment hits it.
std::vector<double> raycast(const world::World& world, const geometry::Pose2& T_world_laser,
                            const BeamPattern& beams);

struct LaserNoise {
  double sigma_m = 0.02;               ///< standard deviation before the tails are cut; >= 0
  double bound_m = 0.05;               ///< largest error, before rounding; >= 0
  double resolution_m = 0.01;          ///< readings are multiples of this; 0: not rounded
  double dropout_probability = 0.002;  ///< for a hit without return; [0, 1]
};

/// Readings for exact ranges: Scan::kNoReturn for infinity and for drop-outs. Uses the same number
/// of drop-out draws for every scan, so that scans of different worlds stay comparable.
std::vector<float> measure(const std::vector<double>& ranges_m, const LaserNoise& noise,
                           support::Random& random);

}  // namespace topogeo::simulation
