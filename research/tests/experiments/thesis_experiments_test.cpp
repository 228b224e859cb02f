// The replicas of the thesis's experiments end with the printed errors (Thesis, 7.3.1.1 and 8.3).
#include "topogeo/experiments/thesis_experiments.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "topogeo/world/world.hpp"

namespace topogeo::simulation {
namespace {

using geometry::Pose2;

world::World thesis_world(const std::string& name) {
  return world::load_world(std::string(TOPOGEO_SHARE) + "/thesis/" + name + ".world.yaml");
}

// The least clearance of the robot on its drive, metres, among the objects present at the start.
double least_room_m(const world::World& world, const SimulatedLog& log) {
  double least = 1e9;
  const world::World scene = world::scene_at(world, 0.0);
  for (const Pose2& pose : log.T_world_robot) {
    least = std::min(least, world::clearance_m(scene, pose.position_m()));
  }
  return least;
}

struct OdometryError {
  double position_m;
  double heading_deg;
};

OdometryError error_at(const SimulatedLog& log, std::size_t i) {
  const Pose2 truth = geometry::between(log.T_world_robot.front(), log.T_world_robot[i]);
  const Pose2 odometry =
      geometry::between(log.scans.front().T_odom_robot, log.scans[i].T_odom_robot);
  const Pose2 off = geometry::between(truth, odometry);
  return {(odometry.position_m() - truth.position_m()).norm(),
          std::fabs(off.theta_rad) * 180.0 / std::numbers::pi};
}

double path_m(const SimulatedLog& log) {
  double sum = 0.0;
  for (std::size_t i = 1; i < log.T_world_robot.size(); ++i) {
    sum += (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm();
  }
  return sum;
}

TEST(ThesisExperiments, CorridorThereAndBack) {
  const world::World world = thesis_world("experiment_1");
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedLog log = simulate_log(world, thesis_experiment_1(seed));
    EXPECT_GT(least_room_m(world, log), 0.3);
    EXPECT_NEAR(path_m(log), 58.0, 1.0);
    std::size_t at_24_m = 0;
    while (log.T_world_robot[at_24_m].x_m < 24.2) ++at_24_m;
    const OdometryError error = error_at(log, at_24_m);
    EXPECT_NEAR(error.position_m, 1.17, 0.6) << "seed " << seed;  // (0.15, 24.21), (-1.02, 24.15)
    EXPECT_LT(error.heading_deg, 6.5) << "seed " << seed;
  }
}

TEST(ThesisExperiments, LoopOf62Stops) {
  const world::World world = thesis_world("experiment_2");
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const SimulatedLog log = simulate_log(world, thesis_experiment_2(seed));
    EXPECT_GT(least_room_m(world, log), 0.3);
    EXPECT_NEAR(path_m(log), 1.5 * 61, 4.0);
    const Pose2 end = geometry::between(log.T_world_robot.front(), log.T_world_robot.back());
    EXPECT_NEAR(end.x_m, 13.8, 0.1);  // ahead
    EXPECT_NEAR(end.y_m, 0.4, 0.1);
    EXPECT_NEAR(std::fabs(end.theta_rad), 3.1, 0.1);
    const OdometryError error = error_at(log, log.scans.size() - 1);
    EXPECT_NEAR(error.position_m, 8.2, 1.2) << "seed " << seed;
    EXPECT_NEAR(error.heading_deg, 17.0, 3.0) << "seed " << seed;
  }
}

}  // namespace
}  // namespace topogeo::simulation
