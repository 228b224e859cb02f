// Sonars: each measures the nearest surface within its cone. Where they sit:
// devices/sonar_ring.hpp.
#pragma once

#include <limits>
#include <numbers>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// The nearest surface in a cone.
struct Echo {
  double range_m = std::numeric_limits<double>::infinity();  ///< infinity: none in range
  double incidence_rad =
      0.0;  ///< between the path of the sound and the surface's normal; 0: an edge
};

/// Exact; `range_max_m`: what is as far or farther has no echo. What changes does not count: see
/// scene_at.
Echo echo(const world::World& scene, const geometry::Pose2& T_world_sonar, double half_cone_rad,
          double range_max_m);

struct SonarNoise {
  double sigma_m = 0.02;       ///< standard deviation; >= 0
  double resolution_m = 0.01;  ///< readings are multiples of this; 0: not rounded
  double range_min_m = 0.15;   ///< nearer surfaces read this; >= 0
  double range_max_m = 5.0;    ///< > range_min_m
  /// Smooth surfaces that the sound meets more obliquely than this throw it elsewhere,
  double specular_from_rad = 25.0 * std::numbers::pi / 180.0;
  double specular_loss_probability = 0.0;  ///< with this probability; [0, 1]
};

/// Readings of a ring; scan::Scan::kNoReturn without an echo. Uses the same count of random
/// numbers for every round.
std::vector<float> measure(const std::vector<Echo>& echoes, const SonarNoise& noise,
                           support::Random& random);

}  // namespace topogeo::simulation
