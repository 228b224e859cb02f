#include "topogeo/navigation/drive_time.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/navigation/path_follower.hpp"
#include "topogeo/support/random.hpp"

#include "test_drive.hpp"

namespace topogeo::navigation {
namespace {

using planning::DrawnZone;
using planning::ZoneKind;

struct Times {
  double estimated_s = 0.0;
  double driven_s = 0.0;
};

/// A drive with noise through a slow zone from wall to wall.
Times drive_through_a_zone(std::uint64_t seed) {
  support::Random random(seed);
  const auto number = [&](double low, double high) { return random.uniform(low, high); };
  DriveSettings settings;
  settings.T_world_start = {number(0.8, 2.0), number(0.8, 5.2),
                            number(-std::numbers::pi, std::numbers::pi)};
  settings.noise = true;
  settings.seed = seed;
  const bool doors = seed % 2 == 0;
  TestDrive drive(doors ? two_doors() : room(), settings);
  const double from_m = number(2.6, 3.2);
  const double to_m = from_m + number(0.5, 1.6);
  const std::vector<DrawnZone> zones = {{"ramp",
                                         {{from_m, -1.0}, {to_m, -1.0}, {to_m, 7.0}, {from_m, 7.0}},
                                         ZoneKind::kSlow,
                                         number(0.1, 0.4)}};
  drive.draw(zones);
  const Eigen::Vector2d goal_m(number(6.0, doors ? 9.0 : 7.2), number(0.8, 5.2));
  const auto route =
      planning::HybridPlanner(*drive.map).plan(settings.T_world_start.position_m(), goal_m);
  EXPECT_TRUE(route.found()) << route.reason;
  Times times;
  times.estimated_s = drive_time_s(route.points_m, settings.T_world_start.theta_rad,
                                   &drive.map->space(), settings.navigator);
  drive.go_to(goal_m);
  const double begin_s = drive.time_s();
  // The last centimetres, which depend on the noise, are not foreseen.
  const auto stands_there = [&] {
    return drive.status().message.starts_with("at the goal") ||
           drive.status().state == NavigatorState::kArrived;
  };
  EXPECT_TRUE(drive.run_until(stands_there, 300.0)) << drive.status().message;
  times.driven_s = drive.time_s() - begin_s;
  return times;
}

FollowerConfig follower() {
  FollowerConfig config;
  config.speed_m_per_s = 0.5;
  config.turn_rad_per_s = 1.0;
  config.acceleration_m_per_s2 = 0.5;
  return config;
}

NavigatorConfig with(const FollowerConfig& follower) {
  NavigatorConfig config;
  config.follower = follower;
  return config;
}

TEST(DriveTime, GrowsByLengthTurnsAndSlowZones) {
  const auto time_s = [](const std::vector<Eigen::Vector2d>& points_m) {
    return drive_time_s(points_m, {}, nullptr, with(follower()));
  };
  EXPECT_EQ(time_s({}), 0.0);
  EXPECT_EQ(time_s({{1.0, 1.0}}), 0.0);
  const double straight_s = time_s({{0.0, 0.0}, {3.0, 0.0}});
  EXPECT_GT(straight_s, 6.0);
  EXPECT_NEAR(time_s({{0.0, 0.0}, {5.0, 0.0}}) - straight_s, 4.0, 0.05);
  // It stops at the corner, turns by a right angle and speeds up again.
  const double corner_s = time_s({{0.0, 0.0}, {3.0, 0.0}, {3.0, -2.0}});
  EXPECT_GT(corner_s, straight_s + 4.0 + std::numbers::pi / 2.0);
  EXPECT_LT(corner_s, straight_s + 4.0 + std::numbers::pi / 2.0 + 3.0);
  const double turned_s = drive_time_s(std::vector<Eigen::Vector2d>{{0.0, 0.0}, {3.0, 0.0}},
                                       std::numbers::pi, nullptr, with(follower()));
  EXPECT_GT(turned_s, straight_s + std::numbers::pi);
}

TEST(DriveTime, OfTheRestIsThatOfTheWholeLessWhatIsDriven) {
  const std::vector<Eigen::Vector2d> points_m = {{0.0, 0.0}, {4.0, 0.0}};
  const auto path = straight_path(points_m);
  std::vector<double> limits(path.size(), 0.5);
  const std::vector<double> free_s = rest_times_s(path, limits, follower());
  for (std::size_t i = path.size() / 2; i < path.size(); ++i) limits[i] = 0.1;
  const std::vector<double> slow_s = rest_times_s(path, limits, follower());
  ASSERT_EQ(free_s.size(), path.size());
  EXPECT_EQ(free_s.back(), 0.0);
  for (std::size_t i = 1; i < path.size(); ++i) EXPECT_LT(free_s[i], free_s[i - 1]) << i;
  EXPECT_NEAR(slow_s.front() - free_s.front(), 2.0 / 0.1 - 2.0 / 0.5, 1.5);
}

TEST(DriveTime, IsWithin15PercentOfDrivesThroughSlowZones) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Times times = drive_through_a_zone(seed);
    EXPECT_NEAR(times.estimated_s, times.driven_s, 0.15 * times.driven_s) << "drive " << seed;
  }
}

}  // namespace
}  // namespace topogeo::navigation
