#include "topogeo/simulation/simulate_log.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "topogeo/support/seed.hpp"

namespace topogeo::simulation {
namespace {

void check(bool ok, const std::string& name, const std::string& expected) {
  if (!ok) throw std::invalid_argument(name + ": expected " + expected);
}

void check(const SimulationOptions& o) {
  check(o.scan_step_m >= 0.01 && o.scan_step_m <= 10.0, "scan_step_m", "[0.01, 10] m");
  check(o.scan_step_rad >= 0.01 && o.scan_step_rad <= std::numbers::pi, "scan_step_rad",
        "[0.01, pi] rad");
  check(o.start_stamp_ns >= 0, "start_stamp_ns", "a number >= 0");
  check(o.beams.count >= 2 && o.beams.count <= 2048, "beams.count", "[2, 2048]");
  check(o.beams.angle_step_rad > 0.0 && std::isfinite(o.beams.angle_step_rad),
        "beams.angle_step_rad", "a number > 0");
  check(o.beams.range_max_m > 0.0, "beams.range_max_m", "a number > 0");
  check(o.laser.sigma_m >= 0.0 && o.laser.bound_m >= 0.0 && o.laser.resolution_m >= 0.0, "laser",
        "sigma_m, bound_m and resolution_m >= 0");
  // Errors are drawn again until they lie within the bound, which must not take for ever.
  check(o.laser.bound_m == 0.0 || o.laser.sigma_m <= 10.0 * o.laser.bound_m, "laser.sigma_m",
        "at most ten times bound_m");
  check(o.laser.dropout_probability >= 0.0 && o.laser.dropout_probability <= 1.0,
        "laser.dropout_probability", "[0, 1]");
}

}  // namespace

SimulatedLog simulate_log(const World& world, const SimulationOptions& options) {
  check(options);
  const std::vector<TimedPose> poses = drive(world.tour_m, options.drive);
  // Separate seeds: a change to the laser leaves the odometry as it was, and the other way round.
  support::Random laser_random(support::derive_seed(options.seed, "laser", {}));
  OdometryModel odometry(options.odometry,
                         support::Random(support::derive_seed(options.seed, "odometry", {})));
  SimulatedLog log;
  double travelled_m = 0.0;
  double turned_rad = 0.0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const geometry::Pose2& T_world_robot = poses[i].T_world_robot;
    if (i > 0) {
      const geometry::Pose2 step = geometry::between(poses[i - 1].T_world_robot, T_world_robot);
      travelled_m += step.position_m().norm();
      turned_rad += std::fabs(step.theta_rad);
    }
    const bool due = travelled_m >= options.scan_step_m || turned_rad >= options.scan_step_rad;
    if (!due && i > 0 && i + 1 < poses.size()) continue;
    travelled_m = 0.0;
    turned_rad = 0.0;
    scan::Scan scan;
    scan.sequence = log.scans.size();
    scan.stamp_ns = options.start_stamp_ns + poses[i].time_ns;
    scan.angle_min_rad = options.beams.angle_min_rad;
    scan.angle_step_rad = options.beams.angle_step_rad;
    scan.ranges_m =
        measure(raycast(world, T_world_robot, options.beams), options.laser, laser_random);
    scan.T_odom_robot = odometry.advance(T_world_robot);
    log.scans.push_back(std::move(scan));
    log.T_world_robot.push_back(T_world_robot);
  }
  return log;
}

}  // namespace topogeo::simulation
