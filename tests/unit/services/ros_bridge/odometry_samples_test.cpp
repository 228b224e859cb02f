#include "ros_bridge/odometry_samples.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros_bridge {
namespace {

ros::Odometry odometry() {
  ros::Odometry message;
  message.header_(ros::header_of("odom", 5));
  message.pose_().pose_(ros::pose_of({1.0, 2.0, 0.5}));
  message.twist_().twist_().linear_().x_(0.4);
  message.twist_().twist_().angular_().z_(-0.2);
  return message;
}

TEST(OdometrySamples, HavePoseAndSpeedsOfTheMessage) {
  const auto sample = to_sample(odometry());
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->stamp_ns, 5);
  EXPECT_EQ(sample->T_odom_robot.x_m, 1.0);
  EXPECT_NEAR(sample->T_odom_robot.theta_rad, 0.5, 1e-12);
  EXPECT_EQ(sample->linear_mps, 0.4);
  EXPECT_EQ(sample->angular_radps, -0.2);
  const msg::Odometry sent = to_msg(*sample, "robot", 7, 3);
  EXPECT_EQ(sent.stamp_ns(), 5);
  EXPECT_EQ(sent.sequence_number(), 3U);
  EXPECT_EQ(sent.odometry_epoch(), 7U);
  EXPECT_EQ(sent.T_odom_robot().y_m(), 2.0);
  EXPECT_EQ(sent.linear_mps(), 0.4);
  EXPECT_EQ(sent.angular_radps(), -0.2);
}

// Finite numbers whose extrapolation by half a second is not finite.
TEST(OdometrySamples, AreOfARobot) {
  for (const double speed : {1e308, -101.0, static_cast<double>(NAN)}) {
    ros::Odometry message = odometry();
    message.twist_().twist_().linear_().x_(speed);
    EXPECT_FALSE(to_sample(message)) << speed;
    message = odometry();
    message.twist_().twist_().angular_().z_(speed);
    EXPECT_FALSE(to_sample(message)) << speed;
  }
  ros::Odometry message = odometry();
  message.pose_().pose_().position_().x_(1e308);
  EXPECT_FALSE(to_sample(message));
}

TEST(OdometrySamples, OfTransformsHaveTheSpeedsSinceTheLast) {
  const auto at = [](double x_m, double yaw_rad, std::int64_t stamp_ns) {
    return ros::transform_of("odom", "base_link", {x_m, 0.0, yaw_rad}, stamp_ns);
  };
  const auto first = to_sample(at(0.0, 0.0, 1'000'000'000), {});
  ASSERT_TRUE(first);
  EXPECT_EQ(first->linear_mps, 0.0);
  const auto second = to_sample(at(0.5, 0.1, 1'500'000'000), first);
  ASSERT_TRUE(second);
  EXPECT_NEAR(second->linear_mps, 1.0, 1e-12);
  EXPECT_NEAR(second->angular_radps, 0.2, 1e-12);
  // A nanosecond later, as from two publishers.
  const auto jumped = to_sample(at(0.6, 0.1, 1'500'000'001), second);
  ASSERT_TRUE(jumped);
  EXPECT_NEAR(jumped->T_odom_robot.x_m, 0.6, 1e-12);
  EXPECT_EQ(jumped->linear_mps, 0.0);
  EXPECT_EQ(jumped->angular_radps, 0.0);
  const auto earlier = to_sample(at(0.4, 0.1, 1'400'000'000), second);
  ASSERT_TRUE(earlier);
  EXPECT_EQ(earlier->linear_mps, 0.0);
  EXPECT_FALSE(to_sample(at(2e8, 0.0, 2'000'000'000), second));
}

}  // namespace
}  // namespace topogeo::ros_bridge
