// The fields that a laser monitors itself, as the second line of defence behind the guard's own
// distances: a robot, its emulated laser on a line, driver and guard in a closed loop.
#include <algorithm>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "topogeo/devices/pls_driver.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/simulation/pls_emulator.hpp"
#include "topogeo/simulation/simulated_robot.hpp"

#include "devices/simulated_line.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kWallX_m = 8.0;
constexpr double kProtective_m = 1.0;
constexpr double kWarning_m = 2.5;
constexpr geometry::Velocity kFullAhead{0.6, 0.0};

simulation::RobotOptions robot_at_the_far_wall() {
  simulation::RobotOptions options;
  options.T_world_start = geometry::Pose2{1.0, 0.0, 0.0};
  options.acceleration_m_per_s2 = 1.5;
  return options;
}

simulation::PlsEmulatorSettings laser_with_fields() {
  simulation::PlsEmulatorSettings settings;
  settings.protective_field_m = kProtective_m;
  settings.warning_field_m = kWarning_m;
  return settings;
}

/// Its guard assumes a laser that faces backwards, like a mounting that has slipped: by its
/// distances nothing is ahead.
class RobotBeforeAWall {
 public:
  explicit RobotBeforeAWall(bool obeys_fields)
      : robot_(world::parse_world("walls: [{from: [8, -3], to: [8, 3]}]\n", "wall"),
               robot_at_the_far_wall()),
        laser_(laser_with_fields(), [this](std::int64_t) { return robot_.scan(); }),
        line_(driver_, laser_),
        guard_(config(obeys_fields)) {
    line_.plug_in();
    line_.run_until(30 * kSecond_ns, [this] { return take_scans(); });
  }

  void drive(double time_s) {
    constexpr std::int64_t kStep_ns = 20'000'000;
    const std::int64_t end_ns = line_.now_ns() + static_cast<std::int64_t>(time_s * 1e9);
    while (line_.now_ns() < end_ns) {
      line_.run_for(kStep_ns);
      static_cast<void>(take_scans());
      guard_.add(OdometrySample{line_.now_ns(), robot_.T_odom_robot()});
      verdict_ = guard_.judge(kFullAhead, line_.now_ns());
      const auto& allowed = verdict_.allowed;
      robot_.step({allowed.linear_m_per_s, allowed.angular_rad_per_s}, 1e-9 * kStep_ns);
      if (to_wall_m() < kWarning_m - 0.5 && to_wall_m() > kProtective_m + 0.2) {
        slowest_m_per_s_ = std::min(slowest_m_per_s_, robot_.velocity().linear_m_per_s);
      }
    }
  }

  /// Distance from the laser, which is at the robot's centre.
  [[nodiscard]] double to_wall_m() const { return kWallX_m - robot_.T_world_robot().x_m; }
  [[nodiscard]] const simulation::SimulatedRobot& robot() const { return robot_; }
  [[nodiscard]] const GuardVerdict& verdict() const { return verdict_; }
  /// Lowest speed between the two fields.
  [[nodiscard]] double slowest_m_per_s() const { return slowest_m_per_s_; }

 private:
  static constexpr std::int64_t kSecond_ns = 1'000'000'000;

  static GuardConfig config(bool obeys_fields) {
    GuardConfig config;
    config.laser_fields = obeys_fields;
    return config;
  }

  bool take_scans() {
    bool any = false;
    for (const devices::LaserScan& scan : driver_.take_scans()) {
      ScanPoints points;
      points.stamp_ns = scan.stamp_ns;
      points.T_odom_robot = robot_.T_odom_robot();
      points.T_robot_laser = {0.0, 0.0, M_PI};
      for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
        const double angle_rad = scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad;
        const auto range_m = static_cast<double>(scan.ranges_m[i]);
        if (range_m > 0.0) {
          points.points_m.push_back(
              points.T_robot_laser *
              Eigen::Vector2d(range_m * std::cos(angle_rad), range_m * std::sin(angle_rad)));
        }
      }
      guard_.add(points);
      guard_.add(LaserFields{scan.stamp_ns, scan.warning_field, scan.protective_field});
      any = true;
    }
    return any;
  }

  simulation::SimulatedRobot robot_;
  simulation::PlsEmulator laser_;
  devices::PlsDriver driver_{devices::PlsSettings{}};
  devices::SimulatedLine line_;
  CollisionGuard guard_;
  GuardVerdict verdict_;
  double slowest_m_per_s_ = 1.0;
};

TEST(LaserFields, SlowAndStopARobotThatTheGuardsDistancesLetGoOn) {
  RobotBeforeAWall drive(true);
  drive.drive(30.0);
  EXPECT_EQ(drive.robot().collisions(), 0U);
  EXPECT_EQ(drive.robot().velocity().linear_m_per_s, 0.0);
  EXPECT_EQ(drive.verdict().reason, HaltReason::kObstacle);
  EXPECT_EQ(drive.verdict().message, "something is in the protective field of the laser");
  EXPECT_NEAR(drive.slowest_m_per_s(), GuardConfig{}.warning_field_m_per_s, 0.01);
  // Readings have errors of centimetres, and it rolls on for a scan and a step.
  EXPECT_NEAR(drive.to_wall_m(), kProtective_m, 0.1);
}

// Shows that this guard's distances do not stop it.
TEST(LaserFields, LeftAloneLetItRunIntoTheWall) {
  RobotBeforeAWall drive(false);
  drive.drive(30.0);
  EXPECT_GT(drive.robot().collisions(), 0U);
}

}  // namespace
}  // namespace topogeo::navigation
