#include "topogeo/simulation/simulated_robot.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "topogeo/simulation/contact.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::simulation {
namespace {

constexpr OdometryDrift kPerfectRobot{.range_scale_error = 0.0,
                                      .range_sigma_m_per_sqrt_m = 0.0,
                                      .heading_drift_rad_per_m = 0.0,
                                      .heading_sigma_rad_per_sqrt_m = 0.0,
                                      .turn_sigma_rad_per_sqrt_rad = 0.0};

// A room of 6 x 4 m with a box in it.
constexpr const char* kRoom =
    "name: room\n"
    "walls: [{from: [0, 0], to: [6, 0]}, {from: [6, 0], to: [6, 4]}, {from: [6, 4], to: [0, 4]}, "
    "{from: [0, 4], to: [0, 0]}]\n"
    "boxes: [{from: [4, 1.5], to: [5, 2.5]}]\n"
    "tour: [[1, 2], [3, 2]]\n";

world::World shipped_world(const char* name) {
  return world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/" + name);
}

TEST(SimulatedRobot, DrivesAsTold) {
  SimulatedRobot robot(world::parse_world(kRoom, "w"), {.odometry = kPerfectRobot});
  EXPECT_EQ(robot.T_world_robot(), (geometry::Pose2{1, 2, 0}));
  const EncoderStep ahead = robot.step({0.5, 0.0}, 1.0);
  EXPECT_NEAR(ahead.forward_m, 0.5, 1e-12);
  EXPECT_NEAR(robot.T_world_robot().x_m, 1.5, 1e-12);
  EXPECT_NEAR(robot.time_s(), 1.0, 1e-12);
  // A quarter circle of 0.5 m to the left.
  robot.step({std::numbers::pi / 4.0, std::numbers::pi / 2.0}, 1.0);
  EXPECT_NEAR(robot.T_world_robot().x_m, 2.0, 1e-4);
  EXPECT_NEAR(robot.T_world_robot().y_m, 2.5, 1e-4);
  EXPECT_NEAR(robot.T_world_robot().theta_rad, std::numbers::pi / 2.0, 1e-12);
  EXPECT_EQ(robot.collisions(), 0U);
  EXPECT_FALSE(robot.bumped_rad());
}

TEST(SimulatedRobot, ABaseThatSteersDoesNotTurnOnTheSpot) {
  SimulatedRobot robot(world::parse_world(kRoom, "w"),
                       {.minimum_turning_radius_m = 0.8, .odometry = kPerfectRobot});
  robot.step({0.0, 1.0}, 1.0);
  EXPECT_EQ(robot.T_world_robot(), (geometry::Pose2{1, 2, 0}));
  EXPECT_EQ(robot.velocity(), Velocity{});
  // A tighter turn becomes one of 0.8 m, ahead and back.
  robot.step({0.4, 2.0}, 1.0);
  EXPECT_NEAR(robot.T_world_robot().theta_rad, 0.5, 1e-9);
  robot.step({-0.4, -2.0}, 1.0);
  EXPECT_NEAR(robot.T_world_robot().theta_rad, 0.0, 1e-9);
  EXPECT_NEAR(robot.T_world_robot().x_m, 1.0, 1e-4);
  // A wall ends the turn, too.
  for (int i = 0; i < 200; ++i) robot.step({0.5, 0.0}, 0.1);
  const double heading_rad = robot.T_world_robot().theta_rad;
  robot.step({0.5, 0.5}, 1.0);
  EXPECT_LT(std::fabs(robot.T_world_robot().theta_rad - heading_rad), 0.1);
}

TEST(SimulatedRobot, GainsSpeedWithItsAcceleration) {
  SimulatedRobot robot(world::parse_world(kRoom, "w"),
                       {.acceleration_m_per_s2 = 0.5, .odometry = kPerfectRobot});
  robot.step({1.0, 0.0}, 1.0);
  EXPECT_NEAR(robot.velocity().linear_m_per_s, 0.5, 1e-9);
  EXPECT_NEAR(robot.T_world_robot().x_m - 1.0, 0.25, 0.01);
  robot.step({0.0, 0.0}, 0.5);
  EXPECT_NEAR(robot.velocity().linear_m_per_s, 0.25, 1e-9);
}

TEST(SimulatedRobot, AContactStopsTheWayAheadAndNothingElse) {
  SimulatedRobot robot(world::parse_world(kRoom, "w"), {.odometry = kPerfectRobot});
  EXPECT_NEAR(robot.free_ahead_m(9.0), 3.0 - 0.267, 1e-9);
  EXPECT_NEAR(robot.free_ahead_m(1.0), 1.0, 1e-9);
  EncoderStep seen = robot.step({1.0, 0.0}, 4.0);
  EXPECT_NEAR(robot.T_world_robot().x_m, 4.0 - 0.267, 1e-9);
  EXPECT_NEAR(seen.forward_m, 3.0 - 0.267, 1e-9);
  EXPECT_EQ(robot.collisions(), 1U);
  ASSERT_TRUE(robot.bumped_rad());
  EXPECT_NEAR(*robot.bumped_rad(), 0.0, 1e-6);
  seen = robot.step({0.0, std::numbers::pi / 2.0}, 1.0);
  EXPECT_NEAR(robot.T_world_robot().theta_rad, std::numbers::pi / 2.0, 1e-9);
  ASSERT_TRUE(robot.bumped_rad());  // it still touches, now on its right side
  EXPECT_NEAR(*robot.bumped_rad(), -std::numbers::pi / 2.0, 1e-6);
  robot.step({0.5, 0.0}, 1.0);  // along the box
  EXPECT_NEAR(robot.T_world_robot().y_m, 2.5, 1e-6);
  EXPECT_EQ(robot.collisions(), 1U);
  EXPECT_EQ(robot.run_into(), 0U);
}

// Driven at random in the rooms of the shipped floor, with slip, doors and people, it never enters
// an obstacle; this test does not use free_path.
TEST(SimulatedRobot, NeverGetsIntoAWall) {
  const world::World floor = shipped_world("floor.world.yaml");
  std::uint64_t collisions = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    RobotOptions options{.seed = seed, .slip = {.per_m = 0.2}};
    options.odometry.lateral_sigma_m_per_sqrt_m = 0.03;
    options.odometry.turn_shift_sigma_m_per_sqrt_rad = 0.03;
    SimulatedRobot robot(floor, options);
    support::Random random(seed);
    for (int i = 0; i < 300; ++i) {
      const Velocity velocity{random.uniform(-0.5, 1.5), random.uniform(-1.5, 1.5)};
      for (int k = 0; k < 25; ++k) {
        robot.step(velocity, 0.04);
        ASSERT_GE(clearance_m(floor, robot.T_world_robot().position_m()), 0.267 - 1e-4);
      }
    }
    EXPECT_EQ(robot.run_into(), 0U);
    collisions += robot.collisions();
  }
  EXPECT_GT(collisions, 50U);
}

TEST(SimulatedRobot, EncoderStepsAddUpToItsOdometry) {
  SimulatedRobot robot(shipped_world("room.world.yaml"), {.seed = 4});
  support::Random random(9);
  geometry::Pose2 sum;
  for (int i = 0; i < 2000; ++i) {
    const EncoderStep step =
        robot.step({random.uniform(-0.2, 0.8), random.uniform(-1.0, 1.0)}, 0.02);
    const double half_rad = step.turn_rad / 2.0;
    sum = sum * geometry::Pose2{step.forward_m * std::cos(half_rad),
                                step.forward_m * std::sin(half_rad), step.turn_rad};
    ASSERT_NEAR(sum.x_m, robot.T_odom_robot().x_m, 1e-9);
    ASSERT_NEAR(sum.y_m, robot.T_odom_robot().y_m, 1e-9);
    ASSERT_NEAR(geometry::wrap_angle(sum.theta_rad - robot.T_odom_robot().theta_rad), 0.0, 1e-9);
  }
}

TEST(SimulatedRobot, PerfectWheelsWithoutSlipKnowTheWay) {
  SimulatedRobot robot(shipped_world("room.world.yaml"), {.odometry = kPerfectRobot});
  const geometry::Pose2 start = robot.T_world_robot();
  support::Random random(2);
  for (int i = 0; i < 500; ++i) {
    robot.step({random.uniform(0.0, 0.8), random.uniform(-1.0, 1.0)}, 0.1);
  }
  const geometry::Pose2 apart =
      geometry::between(start * robot.T_odom_robot(), robot.T_world_robot());
  EXPECT_LT(apart.position_m().norm(), 1e-6);
  EXPECT_LT(std::fabs(apart.theta_rad), 1e-9);
}

TEST(SimulatedRobot, SlippingWheelsRollFartherThanTheRobotGoes) {
  SimulatedRobot robot(
      world::parse_world("segments: [[0, 5, 100, 5]]\ntour: [[0, 0], [90, 0]]\n", "w"),
      {.odometry = kPerfectRobot, .slip = {.per_m = 1.0, .length_m = 0.2}});
  const EncoderStep rolled = robot.step({1.0, 0.0}, 80.0);
  EXPECT_NEAR(rolled.forward_m, 80.0, 1e-6);
  // Every 1.2 m contain 0.2 slippery metres, and half of those are lost.
  EXPECT_NEAR(rolled.forward_m - robot.T_world_robot().x_m, 80.0 * 0.1 / 1.2, 2.0);
}

TEST(SimulatedRobot, SeesWhatIsThere) {
  world::World world = shipped_world("floor.world.yaml");
  world.people.push_back({.path_m = {{4, 1.2}, {8, 1.2}}, .speed_m_per_s = 0.5});
  RobotOptions options;
  options.laser = {.sigma_m = 0.0, .bound_m = 0.0, .resolution_m = 0.0, .dropout_probability = 0.0};
  options.T_robot_laser = {0.1, 0.02, 0.05};
  SimulatedRobot robot(world, options);
  robot.step({0.4, 0.1}, 3.0);
  const world::World scene = robot.scene();
  EXPECT_EQ(scene.circles.size(), world.circles.size() + 1);
  EXPECT_NEAR(scene.circles.back().center_m.x(), 5.5, 1e-9);
  const auto expected_m =
      raycast(scene, robot.T_world_robot() * options.T_robot_laser, options.beams);
  EXPECT_EQ(robot.exact_scan_m(), expected_m);
  const auto readings_m = robot.scan();
  for (std::size_t i = 0; i < expected_m.size(); ++i) {
    if (std::isinf(expected_m[i])) continue;
    ASSERT_EQ(readings_m[i], static_cast<float>(expected_m[i]));
  }
  SonarNoise quiet{.sigma_m = 0.0, .resolution_m = 0.0};
  options.sonar = quiet;
  SimulatedRobot listener(world, options);
  listener.step({0.4, 0.1}, 3.0);
  const auto heard_m = listener.sonar();
  ASSERT_EQ(heard_m.size(), options.sonars.size());
  for (std::size_t i = 0; i < heard_m.size(); ++i) {
    const devices::SonarMount& sonar = options.sonars[i];
    const Echo exact = echo(scene, listener.T_world_robot() * sonar.T_robot_sonar,
                            sonar.half_cone_rad, quiet.range_max_m);
    if (std::isinf(exact.range_m)) continue;
    EXPECT_EQ(heard_m[i], static_cast<float>(std::max(exact.range_m, quiet.range_min_m)));
  }
}

TEST(SimulatedRobot, DoorsAndPeopleRunIntoIt) {
  const char* corridor =
      "walls: [{from: [0, -1], to: [9, -1]}, {from: [4, -1], to: [4, 1], "
      "doors: [{at: 1, width: 0.9, open_s: [[2, 6]]}]}]\n"
      "tour: [[3, 0], [8, 0]]\n";
  SimulatedRobot robot(world::parse_world(corridor, "w"), {.odometry = kPerfectRobot});
  EXPECT_NEAR(robot.free_ahead_m(5.0), 1.0 - 0.267, 1e-9);
  robot.step({0.5, 0.0}, 2.5);
  EXPECT_EQ(robot.collisions(), 1U);  // the door was shut for two seconds
  EXPECT_GT(robot.T_world_robot().x_m, 3.8);
  robot.step({0.0, 0.0}, 4.0);
  EXPECT_EQ(robot.run_into(), 1U);  // then it shuts on the robot
  ASSERT_TRUE(robot.bumped_rad());
  robot.step({-0.5, 0.0}, 1.0);
  EXPECT_FALSE(robot.bumped_rad());

  world::World world = world::parse_world(kRoom, "w");
  world.people.push_back({.path_m = {{1, 1}, {1, 3}}, .speed_m_per_s = 1.0});
  SimulatedRobot stands(world, {});
  stands.step({}, 2.0);
  EXPECT_EQ(stands.run_into(), 1U);
  EXPECT_EQ(stands.collisions(), 0U);
  world.people.back().yields = true;
  SimulatedRobot spared(world, {});
  spared.step({}, 10.0);
  EXPECT_EQ(spared.run_into(), 0U);
}

TEST(SimulatedRobot, ASeedGivesTheSameDrive) {
  const auto end_of = [](std::uint64_t seed) {
    RobotOptions options{.seed = seed, .slip = {.per_m = 0.5}, .wanderers = 2};
    SimulatedRobot robot(shipped_world("floor.world.yaml"), options);
    std::vector<float> readings;
    for (int i = 0; i < 200; ++i) {
      robot.step({0.4, i % 2 == 0 ? 0.3 : -0.3}, 0.1);
      for (const float r : robot.scan()) readings.push_back(r);
      for (const float r : robot.sonar()) readings.push_back(r);
    }
    return std::make_tuple(robot.T_world_robot(), robot.T_odom_robot(), readings);
  };
  EXPECT_EQ(end_of(3), end_of(3));
  EXPECT_NE(end_of(3), end_of(4));
}

TEST(SimulatedRobot, RefusesWhatMakesNoSense) {
  const world::World room = world::parse_world(kRoom, "w");
  const auto refused = [&](auto change) {
    RobotOptions options;
    change(options);
    EXPECT_THROW(SimulatedRobot(room, options), std::invalid_argument);
  };
  refused([](RobotOptions& o) { o.radius_m = 0.0; });
  refused([](RobotOptions& o) { o.acceleration_m_per_s2 = -1.0; });
  refused([](RobotOptions& o) { o.slip.lost_share = 2.0; });
  refused([](RobotOptions& o) { o.T_world_start = geometry::Pose2{0.1, 0.1, 0.0}; });
  refused([](RobotOptions& o) { o.sonars.front().half_cone_rad = 2.0; });
  EXPECT_THROW(SimulatedRobot(world::parse_world("segments: [[0, 0, 1, 1]]", "w"), {}),
               std::invalid_argument);
  SimulatedRobot robot(room, {});
  EXPECT_THROW(robot.step({std::nan(""), 0.0}, 0.1), std::invalid_argument);
  EXPECT_THROW(robot.step({}, -1.0), std::invalid_argument);
}

// A base that accelerates and brakes slowly follows the demo's tour by velocities alone.
TEST(TourFollower, BringsARobotThroughTheFloorWithoutACollision) {
  RobotOptions options{.acceleration_m_per_s2 = 0.6, .angular_acceleration_rad_per_s2 = 3.0};
  SimulatedRobot robot(shipped_world("floor.world.yaml"), options);
  TourFollower follower(shipped_world("floor.world.yaml").tour_m, {.speed_m_per_s = 0.8});
  // The command comes a tenth of a second late.
  Velocity late;
  while (const auto velocity = follower.next(robot.T_world_robot(), 0.1, robot.free_ahead_m(3.0))) {
    robot.step(late, 0.1);
    late = *velocity;
    ASSERT_LT(robot.time_s(), 900.0);
  }
  EXPECT_EQ(robot.collisions(), 0U);
}

TEST(TourFollower, WaitsForPeopleAndDoors) {
  const char* corridor =
      "walls: [{from: [0, -1], to: [20, -1]}, {from: [0, 1], to: [20, 1]}, "
      "{from: [6, -1], to: [6, 1], doors: [{at: 1, width: 0.9, open_s: [[30, 90]]}]}]\n"
      "people: [{path: [[12, 0], [12, 0.9]], speed: 0.2, yields: true}]\n"
      "tour: [[1, 0], [18, 0]]\n";
  const world::World world = world::parse_world(corridor, "w");
  SimulatedRobot robot(world, {.acceleration_m_per_s2 = 0.5});
  TourFollower follower(world.tour_m, {});
  bool waited = false;
  while (const auto velocity = follower.next(robot.T_world_robot(), 0.1, robot.free_ahead_m(3.0))) {
    robot.step(*velocity, 0.1);
    waited = waited || (robot.T_world_robot().x_m > 5.0 && velocity->linear_m_per_s < 0.02);
    ASSERT_LT(robot.time_s(), 90.0) << robot.T_world_robot().x_m;
  }
  EXPECT_TRUE(waited);
  EXPECT_GT(robot.time_s(), 30.0);
  EXPECT_EQ(robot.collisions() + robot.run_into(), 0U);
}

}  // namespace
}  // namespace topogeo::simulation
