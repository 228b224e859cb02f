// A robot with MACONDO's six sonars (two ahead, two on each side), and objects at minimum range.
#include "near_echoes.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/sonar_ring.hpp"

#include "guarded_base.hpp"
#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

constexpr float kNothing_m = 2.0F;
constexpr float kLeast_m = 0.15F;

GuardConfig by_sonars() {
  GuardConfig config;
  config.needs_scan = false;
  config.needs_sonar = true;
  return config;
}

/// Readings ahead (two), left (two), right (two).
SonarRound round_of(const std::vector<float>& ranges_m, std::int64_t stamp_ns) {
  SonarRound round;
  round.stamp_ns = stamp_ns;
  const auto mounts = devices::macondo_sonars();
  for (std::size_t i = 0; i < mounts.size(); ++i) {
    round.readings.push_back(
        {mounts[i].T_robot_sonar, mounts[i].half_cone_rad, ranges_m.at(i / 2)});
  }
  return round;
}

class NearEchoesTest : public testing::Test {
 protected:
  void hear(const geometry::Pose2& T_odom_robot, const std::vector<float>& ranges_m,
            std::int64_t stamp_ns) {
    near.add(OdometrySample{stamp_ns, T_odom_robot});
    near.add(round_of(ranges_m, stamp_ns));
  }

  NearEchoes near{by_sonars()};
};

TEST_F(NearEchoesTest, CurvesAwayFromAWallBesideItAlone) {
  const geometry::Velocity ahead{0.3, 0.0};
  hear({}, {kNothing_m, kNothing_m, kNothing_m}, 0);
  EXPECT_EQ(near.make_room(ahead, 0), ahead);
  hear({}, {kNothing_m, kLeast_m, kNothing_m}, 1);
  EXPECT_LT(near.make_room(ahead, 1).angular_rad_per_s, -0.1);
  EXPECT_EQ(near.make_room(ahead, 1).linear_m_per_s, 0.3);
  // It drives straight through a narrow door.
  hear({}, {kNothing_m, kLeast_m, kLeast_m}, 2);
  EXPECT_EQ(near.make_room(ahead, 2), ahead);
  hear({}, {kNothing_m, kNothing_m, kLeast_m}, 3);
  EXPECT_GT(near.make_room(ahead, 3).angular_rad_per_s, 0.1);
}

TEST_F(NearEchoesTest, MovesOffWhatIsAheadOrBehindWhileItTurns) {
  const geometry::Velocity turn{0.0, 0.6};
  hear({}, {kLeast_m, kNothing_m, kNothing_m}, 0);
  EXPECT_LT(near.make_room(turn, 0).linear_m_per_s, 0.0);
  EXPECT_EQ(near.make_room(turn, 0).angular_rad_per_s, 0.6);
  // No sonar faces backwards: after half a turn the obstacle is remembered behind the robot.
  hear({0.0, 0.0, 3.0}, {kNothing_m, kNothing_m, kNothing_m}, 3 * kSecond_ns);
  EXPECT_GT(near.make_room(turn, 3 * kSecond_ns).linear_m_per_s, 0.0);
  // A decimetre away there is room, and after some seconds its place is no longer known.
  near.add(OdometrySample{3 * kSecond_ns + 1, {-0.1, 0.0, 3.0}});
  EXPECT_EQ(near.make_room(turn, 3 * kSecond_ns + 1), turn);
  near.add(OdometrySample{5 * kSecond_ns, {0.0, 0.0, 3.0}});
  EXPECT_EQ(near.make_room(turn, 5 * kSecond_ns), turn);
}

TEST_F(NearEchoesTest, ForgetsWhatASonarHearsToBeGone) {
  const geometry::Velocity turn{0.0, 0.6};
  hear({}, {kLeast_m, kNothing_m, kNothing_m}, 0);
  hear({}, {kNothing_m, kNothing_m, kNothing_m}, kSecond_ns);
  EXPECT_EQ(near.make_room(turn, kSecond_ns), turn);
}

TEST_F(NearEchoesTest, LeavesOrdersToStandAndRobotsWithALaserAlone) {
  hear({}, {kLeast_m, kLeast_m, kNothing_m}, 0);
  EXPECT_EQ(near.make_room({}, 0), geometry::Velocity{});
  NearEchoes with_laser{GuardConfig{}};
  with_laser.add(OdometrySample{0, {}});
  with_laser.add(round_of({kLeast_m, kLeast_m, kNothing_m}, 0));
  const geometry::Velocity turn{0.0, 0.6};
  EXPECT_EQ(with_laser.make_room(turn, 0), turn);
}

TEST(GuardedBaseBySonars, TurnsWhereThereIsNoRoomToMoveOff) {
  GuardedBase base{by_sonars(), 2.0};
  base.add(OdometrySample{0, {}});
  base.add(round_of({kLeast_m, kNothing_m, kNothing_m}, 0));
  const geometry::Velocity turn{0.0, 0.6};
  EXPECT_LT(base.command(turn, geometry::Pose2{}, 0).verdict.allowed.linear_m_per_s, 0.0);
  // With a drawn wall just behind, it must not step back, and still turns.
  base.keep_off(0, {{-0.29, 0.0}});
  EXPECT_EQ(base.command(turn, geometry::Pose2{}, 0).verdict.allowed, turn);
}

}  // namespace
}  // namespace topogeo::navigation
