#include "base_watch.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "post_scan.hpp"

namespace topogeo::navigation {
namespace {

class BaseWatchTest : public testing::Test {
 protected:
  /// Sends orders ten times a second, from one time to just before another, with current odometry.
  /// Returns the watch's last answer.
  bool ordered(const geometry::Velocity& order, const geometry::Pose2& T_odom_robot, double from_s,
               double to_s) {
    bool stuck = false;
    for (int i = static_cast<int>(std::lround(from_s * 10)); i < std::lround(to_s * 10); ++i) {
      const std::int64_t now_ns = i * kSecond_ns / 10;
      stuck = watch.stuck(order, T_odom_robot, now_ns, now_ns);
    }
    return stuck;
  }

  BaseWatch watch{2.0};
  geometry::Velocity ahead{0.3, 0.0};
};

TEST_F(BaseWatchTest, NoticesABaseThatDoesNotMove) {
  EXPECT_FALSE(ordered(ahead, {}, 0.0, 0.1));
  EXPECT_FALSE(ordered(ahead, {0.005, 0.0, 0.0}, 0.1, 2.0));
  EXPECT_TRUE(ordered(ahead, {0.005, 0.0, 0.0}, 2.0, 2.1));
  EXPECT_FALSE(ordered(ahead, {0.1, 0.0, 0.0}, 2.1, 4.0));
  EXPECT_FALSE(ordered({}, {0.1, 0.0, 0.0}, 4.0, 9.0));
  EXPECT_FALSE(ordered({0.0, 0.5}, {0.1, 0.0, 0.0}, 9.0, 11.0));
  EXPECT_TRUE(ordered({0.0, 0.5}, {0.1, 0.0, 0.0}, 11.0, 11.1));
}

// The base stops by itself without orders, so 9 s without orders are no disobeyed orders.
TEST_F(BaseWatchTest, CountsAnewAfterAGapInTheOrders) {
  EXPECT_FALSE(ordered(ahead, {}, 0.0, 1.0));
  EXPECT_FALSE(ordered(ahead, {}, 10.0, 12.0));
  EXPECT_TRUE(ordered(ahead, {}, 12.0, 12.1));
}

TEST_F(BaseWatchTest, OdometryThatComesLateIsWaitedFor) {
  // Odometry and orders are late by 0.9 s, so the robot's motion is visible after 2.4 s.
  constexpr std::int64_t kLate_ns = 9 * kSecond_ns / 10;
  for (std::int64_t now_ns = 0; now_ns < 24 * kSecond_ns / 10; now_ns += kSecond_ns / 10) {
    EXPECT_FALSE(watch.stuck(ahead, {}, now_ns - kLate_ns, now_ns)) << now_ns;
  }
  for (std::int64_t now_ns = 24 * kSecond_ns / 10; now_ns <= 43 * kSecond_ns / 10;
       now_ns += kSecond_ns / 10) {
    EXPECT_FALSE(watch.stuck(ahead, {0.1, 0.0, 0.0}, now_ns - kLate_ns, now_ns)) << now_ns;
  }
  EXPECT_TRUE(watch.stuck(ahead, {0.1, 0.0, 0.0}, 35 * kSecond_ns / 10, 44 * kSecond_ns / 10));
}

}  // namespace
}  // namespace topogeo::navigation
