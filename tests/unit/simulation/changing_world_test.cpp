// Worlds that change while the robot drives, people, kidnapped robots and blinded lasers.
#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "topogeo/simulation/people.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/simulation/simulated_robot.hpp"

namespace topogeo::simulation {
namespace {

constexpr OdometryDrift kPerfect{.range_scale_error = 0.0,
                                 .range_sigma_m_per_sqrt_m = 0.0,
                                 .heading_drift_rad_per_m = 0.0,
                                 .heading_sigma_rad_per_sqrt_m = 0.0,
                                 .turn_sigma_rad_per_sqrt_rad = 0.0};
constexpr LaserNoise kExact{
    .sigma_m = 0.0, .bound_m = 0.0, .resolution_m = 0.0, .dropout_probability = 0.0};

// A straight drive of 10 m between two walls 2 m apart; beam 180 of 361 points straight ahead.
constexpr const char* kCorridor =
    "walls:\n"
    "  - {from: [0, -1], to: [12, -1]}\n"
    "  - {from: [0, 1], to: [12, 1], doors: [{at: 5, width: 1, open: [[2, 4], [6, 7]]}]}\n"
    "  - {from: [12, -1], to: [12, 1]}\n"
    "tour: [[0, 0], [10, 0]]\n";
constexpr std::size_t kAhead = 180;

SimulationOptions exact() {
  SimulationOptions options;
  options.laser = kExact;
  options.odometry = kPerfect;
  return options;
}

TEST(ChangingWorld, ADoorIsShutButForItsIntervals) {
  const world::World world = world::parse_world(kCorridor, "w");
  ASSERT_EQ(world.changing.size(), 1U);
  const Eigen::Vector2d in_the_door(5.0, 1.0);
  for (const double path_m : {0.0, 1.99, 4.0, 5.9, 7.0, 100.0}) {
    EXPECT_NEAR(clearance_m(scene_at(world, path_m), in_the_door), 0.0, 1e-12) << path_m;
  }
  for (const double path_m : {2.0, 3.99, 6.0}) {
    EXPECT_NEAR(clearance_m(scene_at(world, path_m), in_the_door), 0.5, 1e-12) << path_m;
  }
}

TEST(ChangingWorld, FurnitureIsThereForItsIntervals) {
  const world::World world = world::parse_world(
      "boxes: [{from: [0, 0], to: [1, 1], present: [[0, 5]]}]\n"
      "columns: [{center: [9, 0], radius: 0.5, present: [[5, 9]]}]\n",
      "w");
  EXPECT_EQ(scene_at(world, 4.0).segments.size(), 4U);
  EXPECT_EQ(scene_at(world, 4.0).circles.size(), 0U);
  EXPECT_EQ(scene_at(world, 5.0).segments.size(), 0U);
  EXPECT_EQ(scene_at(world, 5.0).circles.size(), 1U);
}

TEST(ChangingWorld, DoorsAndFurnitureChangeWithTheTimeToo) {
  const world::World world = world::parse_world(
      "walls: [{from: [0, 0], to: [4, 0], doors: [{at: 2, width: 1, open: [[5, 6]], "
      "open_s: [[10, 20]]}]}]\n"
      "columns: [{center: [9, 0], radius: 0.5, present_s: [[3, 4]]}]\n",
      "w");
  EXPECT_EQ(scene_at(world, 0.0, 9.9).segments.size(), 3U);
  EXPECT_EQ(scene_at(world, 0.0, 10.0).segments.size(), 2U);
  EXPECT_EQ(scene_at(world, 5.5, 0.0).segments.size(), 2U);
  EXPECT_EQ(scene_at(world, 0.0, 20.0).segments.size(), 3U);
  EXPECT_EQ(scene_at(world, 0.0, 3.5).circles.size(), 1U);
  EXPECT_EQ(scene_at(world, 0.0, 4.0).circles.size(), 0U);
  EXPECT_EQ(present_parts(world, 5.5, 3.5), (std::vector<bool>{false, true}));
}

TEST(ChangingWorld, RandomDoorsOpenAndShutByTurns) {
  const world::World world = world::parse_world(
      "walls: [{from: [0, 0], to: [4, 0], doors: [{at: 2, width: 1, random: [20, 10]}]}]\n", "w");
  EXPECT_EQ(scene_at(world, 0.0, 50.0).segments.size(), 3U);  // not drawn yet
  const world::World drawn = draw_changes(world, 3, 10000.0);
  int open = 0;
  int changes = 0;
  bool before = true;
  for (int second = 0; second < 10000; ++second) {
    const bool now = scene_at(drawn, 0.0, second).segments.size() == 2U;
    open += now ? 1 : 0;
    changes += now != before ? 1 : 0;
    before = now;
  }
  EXPECT_NEAR(open, 6667, 400);
  EXPECT_NEAR(changes, 667, 60);
  const auto first = [](const world::World& w) { return w.changing[0].present_s.front().to_s; };
  EXPECT_EQ(first(drawn), first(draw_changes(world, 3, 10000.0)));
  EXPECT_NE(first(drawn), first(draw_changes(world, 4, 10000.0)));
  EXPECT_THROW(world::parse_world("boxes: [{from: [0, 0], to: [1, 1], random: [0, 1]}]", "w"),
               std::runtime_error);
  EXPECT_THROW(world::parse_world("boxes: [{from: [0, 0], to: [1, 1], random: 3}]", "w"),
               std::runtime_error);
}

TEST(ChangingWorld, RandomDoorsNeverCeaseToChangeBesideARobot) {
  const world::World world = world::parse_world(
      "walls: [{from: [0, 0], to: [8, 0], doors: [{at: 4, width: 1, random: [20, 10]}]}]\n"
      "tour: [[1, 1], [7, 1]]\n",
      "w");
  constexpr int kHours = 3;
  const world::World drawn = draw_changes(world, 3, 3600.0 * kHours);
  SimulatedRobot robot(world, {.seed = 3});
  for (int second = 0; second < 3600 * kHours; second += 10) {
    ASSERT_EQ(robot.scene().segments.size(), scene_at(drawn, 0.0, robot.time_s()).segments.size())
        << second;
    robot.step({}, 10.0);
  }
}

TEST(ChangingWorld, TheLaserSeesTheDoorAsItIs) {
  const world::World world = world::parse_world(kCorridor, "w");
  const SimulatedLog log = simulate_log(world, exact());
  std::size_t open = 0;
  std::size_t shut = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const double path_m = log.T_world_robot[i].x_m;  // the drive is straight
    const double ahead_m = 5.0 - path_m;             // the door's middle is to the left of it
    if (ahead_m < 0.5 || ahead_m > 3.5) continue;
    const double angle_rad = std::atan2(1.0, ahead_m);
    const auto beam = static_cast<std::size_t>(
        kAhead + static_cast<std::size_t>(std::lround(angle_rad * 360.0 / std::numbers::pi)));
    const bool seen = log.scans[i].ranges_m[beam] != scan::Scan::kNoReturn;
    if (path_m >= 2.0 && path_m < 4.0) {
      EXPECT_FALSE(seen) << path_m;
      ++open;
    } else {
      EXPECT_TRUE(seen) << path_m;
      ++shut;
    }
  }
  EXPECT_GT(open, 3U);
  EXPECT_GT(shut, 1U);
}

TEST(People, WalkTheirPathToAndFro) {
  const world::Person person{
      .path_m = {{0, 0}, {4, 0}, {4, 2}}, .speed_m_per_s = 2.0, .radius_m = 0.2, .start_s = 1.0};
  EXPECT_EQ(position_m(person, 0.0), Eigen::Vector2d(0, 0));
  EXPECT_EQ(position_m(person, 2.0), Eigen::Vector2d(2, 0));
  EXPECT_EQ(position_m(person, 3.5), Eigen::Vector2d(4, 1));
  EXPECT_EQ(position_m(person, 4.5), Eigen::Vector2d(4, 1));  // on the way back
  EXPECT_EQ(position_m(person, 7.0), Eigen::Vector2d(0, 0));
  const world::Person stands{.path_m = {{3, 4}}};
  EXPECT_EQ(position_m(stands, 100.0), Eigen::Vector2d(3, 4));
}

TEST(People, OneAheadIsSeenAtItsDistance) {
  world::World world = world::parse_world(kCorridor, "w");
  world.people.push_back({.path_m = {{8, 0}}, .radius_m = 0.25});
  const SimulatedLog log = simulate_log(world, exact());
  EXPECT_NEAR(static_cast<double>(log.scans[0].ranges_m[kAhead]), 7.75, 1e-5);
  // The robot drives on past; at the person's place only the end of the corridor is visible.
  const auto inside =
      std::find_if(log.T_world_robot.begin(), log.T_world_robot.end(),
                   [](const auto& pose) { return std::fabs(pose.x_m - 8.0) < 0.2; });
  ASSERT_NE(inside, log.T_world_robot.end());
  const auto i = static_cast<std::size_t>(inside - log.T_world_robot.begin());
  EXPECT_NEAR(static_cast<double>(log.scans[i].ranges_m[kAhead]), 12.0 - inside->x_m, 1e-5);
}

TEST(People, WanderersWalkWithinTheirRoomAndKeepOffTheRobot) {
  const world::World room = world::parse_world(
      "walls: [{from: [0, 0], to: [9, 0]}, {from: [9, 0], to: [9, 9]}, {from: [9, 9], to: [0, 9]}, "
      "{from: [0, 9], to: [0, 0]}]\ntour: [[1, 1], [8, 8]]\n",
      "w");
  const Eigen::Vector2d robot_m(1.0, 1.0);
  People people(room, 4, 7);
  std::vector<double> walked_m(4, 0.0);
  std::vector<world::Circle> before = people.circles();
  ASSERT_EQ(before.size(), 4U);
  for (const world::Circle& person : before) EXPECT_GE((person.center_m - robot_m).norm(), 3.0);
  for (int i = 1; i <= 600; ++i) {
    people.walk(0.1 * i, room, robot_m);
    const std::vector<world::Circle> now = people.circles();
    for (std::size_t k = 0; k < now.size(); ++k) {
      const double step_m = (now[k].center_m - before[k].center_m).norm();
      ASSERT_LE(step_m, 0.31);  // two steps at most, by rounding of the time
      walked_m[k] += step_m;
      ASSERT_GE(clearance_m(room, now[k].center_m), 0.3 - 1e-9);
      ASSERT_GE((now[k].center_m - robot_m).norm(), 0.8 - 1e-9);
    }
    before = now;
  }
  for (const double path_m : walked_m) EXPECT_GT(path_m, 10.0);
}

TEST(People, ASeedGivesTheSameWays) {
  const world::World world = world::parse_world(kCorridor, "w");
  SimulationOptions options = exact();
  options.wanderers = 3;
  const SimulatedLog first = simulate_log(world, options);
  const SimulatedLog again = simulate_log(world, options);
  options.seed = 2;
  const SimulatedLog other = simulate_log(world, options);
  bool differs = false;
  for (std::size_t i = 0; i < first.scans.size(); ++i) {
    ASSERT_EQ(first.scans[i].ranges_m, again.scans[i].ranges_m);
    differs = differs || first.scans[i].ranges_m != other.scans[i].ranges_m;
  }
  EXPECT_TRUE(differs);
}

TEST(Kidnapping, MovesTheRobotButNotItsOdometry) {
  const world::World world = world::parse_world(kCorridor, "w");
  SimulationOptions options = exact();
  options.kidnappings = {{.at_path_m = 3.0, .to_path_m = 7.0},
                         {.at_path_m = 5.0, .to_path_m = 1.0}};
  const SimulatedLog log = simulate_log(world, options);
  std::vector<double> jumps_m;
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    const double true_m = log.T_world_robot[i].x_m - log.T_world_robot[i - 1].x_m;
    const double odometry_m = log.scans[i].T_odom_robot.x_m - log.scans[i - 1].T_odom_robot.x_m;
    ASSERT_GT(odometry_m, -1e-9);
    ASSERT_LT(odometry_m, 0.28);
    ASSERT_GT(log.scans[i].stamp_ns, log.scans[i - 1].stamp_ns);
    if (std::fabs(true_m - odometry_m) > 1e-9) jumps_m.push_back(true_m - odometry_m);
  }
  ASSERT_EQ(jumps_m.size(), 2U);
  EXPECT_NEAR(jumps_m[0], 4.0, 0.02);
  EXPECT_NEAR(jumps_m[1], -8.0, 0.04);  // at 9 m, two metres after 7 m
  EXPECT_NEAR(log.T_world_robot.back().x_m, 10.0, 0.06);
  EXPECT_NEAR(log.scans.back().T_odom_robot.x_m, 14.0, 0.1);
}

TEST(Blinding, ScansOfThatPartSeeNothing) {
  const world::World world = world::parse_world(kCorridor, "w");
  SimulationOptions options = exact();
  options.blindings = {{{1.0, 2.0}, {}}, {{4.0, 5.0}, 0.1}};
  const SimulatedLog log = simulate_log(world, options);
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    const double path_m = log.T_world_robot[i].x_m;
    const float ahead_m = log.scans[i].ranges_m[kAhead];
    if (path_m >= 1.0 && path_m < 2.0) {
      EXPECT_EQ(ahead_m, scan::Scan::kNoReturn);
    } else if (path_m >= 4.0 && path_m < 5.0) {
      EXPECT_EQ(ahead_m, 0.1F);
    } else {
      EXPECT_NEAR(static_cast<double>(ahead_m), 12.0 - path_m, 1e-5);
    }
  }
}

TEST(SimulateLog, TheLaserMayBeMountedAnywhere) {
  const world::World world = world::parse_world(kCorridor, "w");
  SimulationOptions options = exact();
  options.T_robot_laser = {0.3, 0.2, std::numbers::pi};
  const SimulatedLog log = simulate_log(world, options);
  // Then the first beam points to the robot's left, the last to its right.
  EXPECT_NEAR(static_cast<double>(log.scans[0].ranges_m.front()), 0.8, 1e-5);
  EXPECT_NEAR(static_cast<double>(log.scans[0].ranges_m.back()), 1.2, 1e-5);
}

TEST(ChangingWorld, OptionsOutOfRangeAreErrors) {
  const world::World world = world::parse_world(kCorridor, "w");
  const auto refused = [&](auto change) {
    SimulationOptions options;
    change(options);
    EXPECT_THROW(simulate_log(world, options), std::invalid_argument);
  };
  refused([](SimulationOptions& o) { o.kidnappings = {{-1.0, 1.0}}; });
  refused([](SimulationOptions& o) { o.kidnappings = {{1.0, 1000.0}}; });
  refused([](SimulationOptions& o) { o.kidnappings = {{2.0, 1.0}, {1.0, 1.0}}; });
  refused([](SimulationOptions& o) { o.blindings = {{{2.0, 1.0}, {}}}; });
  refused([](SimulationOptions& o) { o.blindings = {{{1.0, 2.0}, -1.0}}; });
}

}  // namespace
}  // namespace topogeo::simulation
