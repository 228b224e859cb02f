// A robot that has lost its pose in free space.
#include "relocalization.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

using testing::HasSubstr;

class RelocalizationTest : public testing::Test {
 protected:
  RelocalizationTest() {
    guard.add(OdometrySample{0, {}});
    guard.add(scan_of_post(5.0, 0));
  }

  Relocalization::Lost lost{"no pose received yet", true, false, geometry::Pose2{}};
  CollisionGuard guard{GuardConfig{}};
};

TEST_F(RelocalizationTest, StandsFirstAndThenLooksAround) {
  Relocalization relocalization(5.0);
  relocalization.begin(0);
  const auto first = relocalization.step(lost, guard, kSecond_ns / 2);
  EXPECT_FALSE(first.wanted);
  EXPECT_EQ(first.message, "no pose received yet");
  const auto second = relocalization.step(lost, guard, 2 * kSecond_ns);
  ASSERT_TRUE(second.wanted);
  EXPECT_EQ(second.wanted->linear_m_per_s, 0.0);
  EXPECT_NE(second.wanted->angular_rad_per_s, 0.0);
  EXPECT_THAT(second.message, HasSubstr("looks around, 0.0 of 5.0 m"));
  relocalization.begin(2 * kSecond_ns);
  EXPECT_FALSE(relocalization.step(lost, guard, 2 * kSecond_ns).wanted);
}

TEST_F(RelocalizationTest, MovesOnlyWhereItMay) {
  Relocalization relocalization(5.0);
  relocalization.begin(0);
  lost.may_look_around = false;
  EXPECT_FALSE(relocalization.step(lost, guard, 2 * kSecond_ns).wanted);
  lost.doubtful = true;  // one turn makes a doubtful pose sure
  EXPECT_TRUE(relocalization.step(lost, guard, 2 * kSecond_ns).wanted);
  lost.T_odom_robot.reset();
  EXPECT_FALSE(relocalization.step(lost, guard, 2 * kSecond_ns).wanted);
  lost.T_odom_robot = geometry::Pose2{};
  EXPECT_FALSE(Relocalization(0.0).step(lost, guard, 2 * kSecond_ns).wanted);
}

TEST_F(RelocalizationTest, ADoubtfulPoseGetsOneTurn) {
  Relocalization relocalization(5.0);
  relocalization.begin(0);
  lost.may_look_around = false;
  lost.doubtful = true;
  int steps = 0;
  for (; steps < 200; ++steps) {
    lost.T_odom_robot = geometry::Pose2{0.0, 0.0, geometry::wrap_angle(0.1 * steps)};
    if (!relocalization.step(lost, guard, 2 * kSecond_ns).wanted) break;
  }
  EXPECT_NEAR(0.1 * steps, 6.3, 0.3);
}

}  // namespace
}  // namespace topogeo::navigation
