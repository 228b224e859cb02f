// Drives through made worlds with a laser at a known place of the robot, and their motions.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "topogeo/calibration/mounting_search.hpp"

#include "localization/simulated_maps.hpp"

namespace topogeo::localization::test {

using Points_m = std::vector<Eigen::Vector2d>;

/// Corridor, corner, corridor and back: 55 m with turns to both sides.
inline const Points_m kRound_m = {{1.3, 1.2},  {15.0, 1.15}, {28.9, 1.2},
                                  {28.9, 9.0}, {28.9, 1.2},  {20.0, 1.15}};

inline std::vector<scan::Scan> drive(const std::string& name, const Points_m& tour_m,
                                     const geometry::Pose2& T_robot_laser) {
  world::World world = test::world(name);
  if (!tour_m.empty()) world.tour_m = tour_m;
  simulation::SimulationOptions options;
  options.T_robot_laser = T_robot_laser;
  return simulation::simulate_log(world, options).scans;
}

/// The scans of the same laser upside down: its beams go the other way.
inline void mirror(std::vector<scan::Scan>& scans) {
  for (scan::Scan& scan : scans) {
    const double last_rad =
        scan.angle_min_rad + scan.angle_step_rad * static_cast<double>(scan.ranges_m.size() - 1);
    scan.angle_min_rad = -last_rad;
    std::ranges::reverse(scan.ranges_m);
  }
}

inline std::vector<LaserMotion> motions_of(const std::vector<scan::Scan>& scans) {
  LaserMotions motions;
  for (const scan::Scan& scan : scans) {
    motions.add(topomap::scan_points(scan, {}, 20.0), scan.stamp_ns, scan.T_odom_robot,
                scan.odometry_epoch);
  }
  return motions.motions();
}

}  // namespace topogeo::localization::test
