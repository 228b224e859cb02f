// Small worlds of line segments and scans of a laser in them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::test_world {

struct Segment {
  double x0, y0, x1, y1;
};
using World = std::vector<Segment>;

/// Beams evenly over a field of view around the forward direction.
struct Laser {
  std::size_t beams = 361;
  double field_of_view_deg = 180.0;
  double range_max_m = 50.0;
};

inline double range_to(const World& world, const geometry::Pose2& T_world_laser, double angle_rad) {
  const double dx = std::cos(T_world_laser.theta_rad + angle_rad);
  const double dy = std::sin(T_world_laser.theta_rad + angle_rad);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const Segment& s : world) {
    const double ex = s.x1 - s.x0;
    const double ey = s.y1 - s.y0;
    const double cross = dx * ey - dy * ex;
    if (std::abs(cross) < 1e-12) continue;
    const double ox = s.x0 - T_world_laser.x_m;
    const double oy = s.y0 - T_world_laser.y_m;
    const double range_m = (ox * ey - oy * ex) / cross;
    const double along = (ox * dy - oy * dx) / cross;
    if (range_m > 0.0 && along >= 0.0 && along <= 1.0) nearest_m = std::min(nearest_m, range_m);
  }
  return nearest_m;
}

inline scan::Scan scan_of(const World& world, const geometry::Pose2& T_world_laser = {},
                          const Laser& laser = {}) {
  scan::Scan scan;
  const double view_rad = laser.field_of_view_deg * std::numbers::pi / 180.0;
  // A full turn must not repeat a beam.
  const bool closed = laser.field_of_view_deg >= 360.0;
  const auto steps = static_cast<double>(closed ? laser.beams : laser.beams - 1);
  scan.angle_step_rad = steps > 0.0 ? view_rad / steps : view_rad;
  scan.angle_min_rad = laser.beams > 1 ? -0.5 * view_rad : 0.0;
  for (std::size_t i = 0; i < laser.beams; ++i) {
    const double range_m = range_to(
        world, T_world_laser, scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    scan.ranges_m.push_back(range_m < laser.range_max_m ? static_cast<float>(range_m)
                                                        : scan::Scan::kNoReturn);
  }
  return scan;
}

/// A closed room with boxes and single walls; the laser is in free space at the origin.
inline World random_world(std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / 4294967296.0;
  };
  const double w = uniform(2.0, 12.0);
  const double h = uniform(2.0, 12.0);
  World world{{-w, -h, w, -h}, {w, -h, w, h}, {w, h, -w, h}, {-w, h, -w, -h}};
  const int things = static_cast<int>(uniform(1.0, 12.0));
  for (int i = 0; i < things; ++i) {
    const double angle_rad = uniform(0.0, 6.28);
    const double range_m = uniform(1.0, 8.0);
    const double x = range_m * std::cos(angle_rad);
    const double y = range_m * std::sin(angle_rad);
    world.push_back({x, y, x + uniform(-2.0, 2.0), y + uniform(-2.0, 2.0)});
  }
  return world;
}

}  // namespace topogeo::test_world
