// The collision guard in front of drawn walls and no-go zones.
#include "topogeo/navigation/drawn_limits.hpp"

#include <cmath>

#include <gmock/gmock.h>

#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::navigation {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kDrivenAt_ns = 5'000'000'000;

/// A hall of 12 x 12 m, cells of 0.1 m.
planning::FreeSpace hall_with(const std::vector<planning::DrawnZone>& zones,
                              const std::vector<planning::DrawnLine>& lines) {
  planning::GridFrame frame;
  frame.columns = frame.rows = 120;
  frame.T_map_grid = {-6.0, -6.0, 0.0};
  return planning::FreeSpace(planning::OccupancyGrid(frame, planning::CellState::kFree), {}, zones,
                             lines);
}

const std::vector<planning::DrawnLine> kWall{
    {planning::LineKind::kWall, {{2.05, -3.0}, {2.05, 3.0}}}};
const std::vector<planning::DrawnZone> kPool{
    {"pool", {{1.0, 1.0}, {3.0, 1.0}, {3.0, 3.0}, {1.0, 3.0}}, planning::ZoneKind::kNoGo},
    {"room", {{-5.0, -5.0}, {-4.0, -5.0}, {-4.0, -4.0}}}};

CollisionGuard guard_at(const DrawnLimits& limits, const geometry::Pose2& T_map_robot) {
  CollisionGuard guard({});
  guard.add(OdometrySample{kDrivenAt_ns, {}});
  ScanPoints scan;
  scan.stamp_ns = kDrivenAt_ns;
  guard.add(scan);
  guard.keep_off(kDrivenAt_ns, limits.near_m(T_map_robot));
  return guard;
}

TEST(DrawnLimits, ADrawnWallStopsLikeAWall) {
  const DrawnLimits limits(hall_with({}, kWall));
  const GuardConfig config;
  const GuardVerdict verdict = guard_at(limits, {}).judge({2.0, 0.0}, kDrivenAt_ns);
  // The distance to the centres of the wall's cells, which are 5 cm off the robot's line.
  const double body_m = config.radius_m + config.side_margin_m;
  EXPECT_NEAR(verdict.free_m, 2.05 - std::sqrt(body_m * body_m - 0.05 * 0.05), 1e-9);
  EXPECT_TRUE(verdict.limited);
  EXPECT_THAT(verdict.message, HasSubstr("a drawn wall or no-go zone"));
  EXPECT_FALSE(verdict.contact_m) << "nothing stands there that the planner should hear of";
  const GuardVerdict before = guard_at(limits, {1.75, 0.0, 0.0}).judge({0.3, 0.0}, kDrivenAt_ns);
  EXPECT_EQ(before.allowed, geometry::Velocity{});
  EXPECT_EQ(before.reason, HaltReason::kObstacle);
  EXPECT_EQ(
      guard_at(limits, {1.75, 0.0, 3.1}).judge({0.3, 0.0}, kDrivenAt_ns).allowed.linear_m_per_s,
      0.3)
      << "away from it";
}

TEST(DrawnLimits, ANoGoZoneStopsFromOutsideAndLetsOut) {
  const DrawnLimits limits(hall_with(kPool, {}));
  EXPECT_EQ(guard_at(limits, {0.75, 2.0, 0.0}).judge({0.3, 0.0}, kDrivenAt_ns).allowed,
            geometry::Velocity{});
  EXPECT_EQ(
      guard_at(limits, {2.0, 2.0, 0.0}).judge({0.3, 0.0}, kDrivenAt_ns).allowed.linear_m_per_s, 0.3)
      << "inside: it may leave";
  EXPECT_EQ(
      guard_at(limits, {-4.2, -4.8, 0.0}).judge({0.3, 0.0}, kDrivenAt_ns).allowed.linear_m_per_s,
      0.3)
      << "rooms stop nobody";
  EXPECT_TRUE(DrawnLimits().empty());
  EXPECT_THAT(DrawnLimits().near_m({}), IsEmpty());
}

// For any commands, the body never enters the zone or crosses the wall.
TEST(DrawnLimits, NoDriveCrossesThem) {
  const planning::FreeSpace hall = hall_with(kPool, kWall);
  const DrawnLimits limits(hall);
  const GuardConfig config;
  constexpr double kStep_s = 0.05;
  constexpr std::int64_t kStep_ns = 50'000'000;
  int stops = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    support::Random random(seed);
    CollisionGuard guard(config);
    geometry::Pose2 T_map_robot{-1.0, random.uniform(-1.0, 2.5), 0.0};
    geometry::Velocity wanted{0.6, 0.0};
    for (std::int64_t i = 1; i <= 400; ++i) {
      const std::int64_t now_ns = i * kStep_ns;
      guard.add(OdometrySample{now_ns, T_map_robot});
      ScanPoints scan;
      scan.stamp_ns = now_ns;
      scan.T_odom_robot = T_map_robot;
      guard.add(scan);
      guard.keep_off(now_ns, limits.near_m(T_map_robot));
      if (i % 20 == 0) wanted = {random.uniform(0.0, 0.8), random.uniform(-0.6, 0.6)};
      const GuardVerdict verdict = guard.judge(wanted, now_ns);
      if (verdict.reason == HaltReason::kObstacle) ++stops;
      const geometry::Velocity& v = verdict.allowed;
      T_map_robot = T_map_robot *
                    geometry::Pose2{v.linear_m_per_s * kStep_s, 0.0, v.angular_rad_per_s * kStep_s};
      const Eigen::Vector2d at_m = T_map_robot.position_m();
      for (const planning::Cell& cell : hall.rules().no_go()) {
        ASSERT_GT((hall.frame().center_m(cell) - at_m).norm(), config.radius_m) << seed;
      }
    }
  }
  EXPECT_GT(stops, 100) << "it was held";
}

TEST(DrawnLimits, OdometryCarriesThemOnForThreeMetres) {
  const DrawnLimits limits(hall_with({}, kWall));
  CollisionGuard guard = guard_at(limits, {0.0, 0.0, 0.0});
  const auto free_after_m = [&](double driven_m, std::int64_t now_ns) {
    guard.add(OdometrySample{now_ns, {driven_m, 0.0, 0.0}});
    ScanPoints scan;
    scan.stamp_ns = now_ns;
    scan.T_odom_robot = {driven_m, 0.0, 0.0};
    guard.add(scan);
    return guard.judge({0.5, 0.0}, now_ns).free_m;
  };
  const double at_first_m = free_after_m(0.0, kDrivenAt_ns + 1);
  EXPECT_NEAR(free_after_m(1.0, kDrivenAt_ns + 100'000'000), at_first_m - 1.0, 1e-9);
  // Backwards, away from the wall, until its place is no longer known.
  EXPECT_LT(free_after_m(-2.9, kDrivenAt_ns + 200'000'000), CollisionGuard::kFarthest_m);
  EXPECT_EQ(free_after_m(-3.1, kDrivenAt_ns + 300'000'000), CollisionGuard::kFarthest_m);
  EXPECT_NEAR(free_after_m(1.0, kDrivenAt_ns + 400'000'000), at_first_m - 1.0, 1e-9);
  guard.keep_off(kDrivenAt_ns + 400'000'000, {});
  EXPECT_EQ(free_after_m(1.0, kDrivenAt_ns + 500'000'000), CollisionGuard::kFarthest_m);
}

}  // namespace
}  // namespace topogeo::navigation
