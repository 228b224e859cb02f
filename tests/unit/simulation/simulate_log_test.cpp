#include "topogeo/simulation/simulate_log.hpp"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

world::World shipped(const char* name) {
  return world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/" + name);
}

// FNV-1a over the whole content of a log.
std::uint64_t digest(const SimulatedLog& log) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto add = [&hash](const auto& value) {
    unsigned char bytes[sizeof(value)];
    std::memcpy(bytes, &value, sizeof(value));
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 0x100000001b3ULL;
  };
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    add(log.scans[i].stamp_ns);
    for (const float range_m : log.scans[i].ranges_m) add(range_m);
    for (const auto& pose : {log.scans[i].T_odom_robot, log.T_world_robot[i]}) {
      add(pose.x_m);
      add(pose.y_m);
      add(pose.theta_rad);
    }
  }
  return hash;
}

TEST(SimulateLog, ScansAreWellFormedAndSpacedAsAsked) {
  const SimulationOptions options;
  const SimulatedLog log = simulate_log(shipped("room.world.yaml"), options);
  ASSERT_EQ(log.scans.size(), log.T_world_robot.size());
  ASSERT_GT(log.scans.size(), 30U);
  EXPECT_EQ(log.scans[0].stamp_ns, options.start_stamp_ns);
  EXPECT_EQ(log.scans[0].T_odom_robot, geometry::Pose2());
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    ASSERT_EQ(log.scans[i].sequence, i);
    ASSERT_EQ(log.scans[i].ranges_m.size(), 361U);
    if (i == 0) continue;
    ASSERT_GT(log.scans[i].stamp_ns, log.scans[i - 1].stamp_ns);
    const auto step = geometry::between(log.T_world_robot[i - 1], log.T_world_robot[i]);
    ASSERT_LE(step.position_m().norm(), options.scan_step_m + 0.02);
    ASSERT_LE(std::fabs(step.theta_rad), options.scan_step_rad + 0.025);
  }
}

TEST(SimulateLog, RangesAreThoseOfTheTruePose) {
  const world::World world = shipped("room.world.yaml");
  SimulationOptions options;
  options.laser.dropout_probability = 0.0;
  const SimulatedLog log = simulate_log(world, options);
  for (std::size_t i = 0; i < log.scans.size(); i += 10) {
    const auto exact_m = raycast(world, log.T_world_robot[i], options.beams);
    for (std::size_t k = 0; k < exact_m.size(); ++k) {
      ASSERT_NEAR(static_cast<double>(log.scans[i].ranges_m[k]), exact_m[k], 0.0551);
    }
  }
}

TEST(SimulateLog, ASeedGivesTheSameBytesEverywhere) {
  const world::World world = shipped("corridor.world.yaml");
  const auto first = digest(simulate_log(world, {.seed = 7}));
  EXPECT_EQ(first, digest(simulate_log(world, {.seed = 7})));
  EXPECT_NE(first, digest(simulate_log(world, {.seed = 8})));
  // The value itself, to detect differences of compilers, libraries or machines.
  EXPECT_EQ(first, 345217238399167202ULL);
}

TEST(SimulateLog, LaserAndOdometryNoiseAreIndependent) {
  const world::World world = shipped("room.world.yaml");
  SimulationOptions quiet;
  quiet.laser.sigma_m = 0.0;
  const SimulatedLog a = simulate_log(world, {});
  const SimulatedLog b = simulate_log(world, quiet);
  ASSERT_EQ(a.scans.size(), b.scans.size());
  EXPECT_EQ(a.scans.back().T_odom_robot, b.scans.back().T_odom_robot);
  EXPECT_NE(a.scans.back().ranges_m, b.scans.back().ranges_m);
}

TEST(SimulateLog, OptionsOutOfRangeAreErrors) {
  const world::World world = shipped("room.world.yaml");
  const auto refused = [&](auto change) {
    SimulationOptions options;
    change(options);
    EXPECT_THROW(simulate_log(world, options), std::invalid_argument);
  };
  refused([](SimulationOptions& o) { o.scan_step_m = 0.0; });
  refused([](SimulationOptions& o) { o.scan_step_rad = std::nan(""); });
  refused([](SimulationOptions& o) { o.start_stamp_ns = -1; });
  refused([](SimulationOptions& o) { o.beams.count = 0; });
  refused([](SimulationOptions& o) { o.laser.sigma_m = 9.0; });
  refused([](SimulationOptions& o) { o.laser.dropout_probability = 1.5; });
  refused([](SimulationOptions& o) { o.drive.speed_m_per_s = 0.0; });
  EXPECT_THROW(simulate_log(world::parse_world("segments: [[0, 0, 1, 1]]", "w"), {}),
               std::invalid_argument);
}

// The floor of the demo.
TEST(Floor, TourKeepsClearOfEverythingAndIsLongEnough) {
  const world::World world = shipped("floor.world.yaml");
  double path_m = 0.0;
  const auto poses = drive(world.tour_m, {});
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Eigen::Vector2d here_m = poses[i].T_world_robot.position_m();
    path_m += (here_m - poses[i - 1].T_world_robot.position_m()).norm();
    // Steps of up to 5 cm are enough to find a wall.
    if (i % 3 != 0) continue;
    ASSERT_GT(clearance_m(world, here_m), 0.3) << here_m.transpose();
  }
  EXPECT_GE(path_m, 120.0);
  EXPECT_LE(path_m, 200.0);
}

// Without drift there would be nothing to correct; too much could not be corrected.
TEST(Floor, OdometryDriftsByMetresAndDegrees) {
  const world::World world = shipped("floor.world.yaml");
  SimulationOptions options;
  options.beams.count = 2;  // only the odometry matters here
  const SimulatedLog log = simulate_log(world, options);
  double worst_m = 0.0;
  double worst_rad = 0.0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const auto error =
        geometry::between(log.T_world_robot[i], log.T_world_robot[0] * log.scans[i].T_odom_robot);
    worst_m = std::max(worst_m, error.position_m().norm());
    worst_rad = std::max(worst_rad, std::fabs(error.theta_rad));
  }
  EXPECT_GT(worst_m, 2.0);
  EXPECT_LT(worst_m, 15.0);
  EXPECT_GT(worst_rad, 0.15);
  EXPECT_LT(worst_rad, 0.8);
}

}  // namespace
}  // namespace topogeo::simulation
