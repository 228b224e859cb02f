// Sonars: each measures the nearest surface within its cone. Their mounting is in
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

/// Exact; surfaces at `range_max_m` or farther have no echo. Changing parts are ignored: see
/// scene_at.
Echo echo(const world::World& scene, const geometry::Pose2& T_world_sonar, double half_cone_rad,
          double range_max_m);

struct SonarNoise {
  double sigma_m = 0.02;       ///< standard deviation; >= 0
  double resolution_m = 0.01;  ///< readings are multiples of this; 0: not rounded
  double range_min_m = 0.15;   ///< nearer surfaces read this; >= 0
  double range_max_m = 5.0;    ///< > range_min_m
  /// Smooth surfaces at a larger angle of incidence than this reflect the sound away,
  double specular_from_rad = 25.0 * std::numbers::pi / 180.0;
  double specular_loss_probability = 0.0;  ///< with this probability; [0, 1]
  /// Share of the sound reflected away that returns over another surface: the reading is up to
  /// reflection_detour_m longer; [0, 1]
  double reflection_probability = 0.0;
  double reflection_detour_m = 2.5;  ///< >= 0
  double missing_probability = 0.0;  ///< for a lost echo; [0, 1]
  /// Beyond this distance readings have errors of up to far_error_m,
  double far_from_m = 2.5;
  double far_error_m = 0.30;
  double far_error_probability = 0.0;  ///< with this probability; [0, 1]
};

/// The sonars of MACONDO, III.1: exact up to 2.5 m (here to 2 cm); from 2.5 to 5 m three of four
/// readings have errors of up to 30 cm; none beyond. It has no figures for reflections and missing
/// echoes: here 60 % of the sound that meets a wall at more than 25 degrees is lost, half of which
/// returns over another wall, and 3 % of all echoes are missing.
SonarNoise macondo_sonar_noise();

/// Readings of a ring; scan::Scan::kNoReturn without an echo. The same settings use the same number
/// of random draws for every round.
std::vector<float> measure(const std::vector<Echo>& echoes, const SonarNoise& noise,
                           support::Random& random);

}  // namespace topogeo::simulation
