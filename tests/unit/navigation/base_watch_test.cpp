#include "base_watch.hpp"

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

/// The odometry is of the moment.
bool stuck(BaseWatch& watch, const geometry::Velocity& ordered, const geometry::Pose2& T_odom_robot,
           std::int64_t now_ns) {
  return watch.stuck(ordered, T_odom_robot, now_ns, now_ns);
}

TEST(BaseWatch, NoticesABaseThatDoesNotMove) {
  BaseWatch watch(2.0);
  const geometry::Velocity ordered{0.3, 0.0};
  EXPECT_FALSE(stuck(watch, ordered, {}, 0));
  EXPECT_FALSE(stuck(watch, ordered, {0.005, 0.0, 0.0}, 1 * kSecond_ns));
  EXPECT_TRUE(stuck(watch, ordered, {0.005, 0.0, 0.0}, 2 * kSecond_ns));
  EXPECT_FALSE(stuck(watch, ordered, {0.1, 0.0, 0.0}, 3 * kSecond_ns));
  EXPECT_FALSE(stuck(watch, {}, {0.1, 0.0, 0.0}, 9 * kSecond_ns));
  EXPECT_FALSE(stuck(watch, {0.0, 0.5}, {0.1, 0.0, 0.0}, 10 * kSecond_ns));
  EXPECT_TRUE(stuck(watch, {0.0, 0.5}, {0.1, 0.0, 0.0}, 12 * kSecond_ns));
}

TEST(BaseWatch, OdometryThatComesLateIsWaitedFor) {
  BaseWatch watch(2.0);
  const geometry::Velocity ordered{0.3, 0.0};
  // It comes 0.9 s late, and so does the order to the base: the robot is seen to move after 2.4 s.
  constexpr std::int64_t kLate_ns = 9 * kSecond_ns / 10;
  for (std::int64_t now_ns = 0; now_ns < 24 * kSecond_ns / 10; now_ns += kSecond_ns / 10) {
    EXPECT_FALSE(watch.stuck(ordered, {}, now_ns - kLate_ns, now_ns)) << now_ns;
  }
  EXPECT_FALSE(watch.stuck(ordered, {0.1, 0.0, 0.0}, 15 * kSecond_ns / 10, 24 * kSecond_ns / 10));
  EXPECT_FALSE(watch.stuck(ordered, {0.1, 0.0, 0.0}, 34 * kSecond_ns / 10, 43 * kSecond_ns / 10));
  EXPECT_TRUE(watch.stuck(ordered, {0.1, 0.0, 0.0}, 35 * kSecond_ns / 10, 44 * kSecond_ns / 10));
}

}  // namespace
}  // namespace topogeo::navigation
