#include "ros_bridge/orders.hpp"

#include <cmath>
#include <numbers>
#include <variant>

#include <gtest/gtest.h>

#include "ros_conversions/ros_messages.hpp"

namespace topogeo::ros_bridge {
namespace {

ros::PoseStamped pose_in(const std::string& frame, const geometry::Pose2& pose) {
  ros::PoseStamped message;
  message.header_(ros::header_of(frame, 0));
  message.pose_(ros::pose_of(pose));
  return message;
}

TEST(RosOrders, AGoalMayBeInAnyFrameThatIsKnown) {
  const Settings::Frames frames;
  const geometry::Pose2 T_map_odom{1.0, 0.0, std::numbers::pi / 2.0};
  const service::Goal on_map = to_goal(pose_in("/map", {2.0, 3.0, 0.5}), frames, {}, {});
  EXPECT_EQ(std::get<Eigen::Vector2d>(on_map.target), Eigen::Vector2d(2.0, 3.0));
  EXPECT_NEAR(*on_map.heading_rad, 0.5, 1e-12);
  const service::Goal by_odom = to_goal(pose_in("odom", {2.0, 0.0, 0.5}), frames, T_map_odom, {});
  EXPECT_NEAR(std::get<Eigen::Vector2d>(by_odom.target).x(), 1.0, 1e-12);
  EXPECT_NEAR(std::get<Eigen::Vector2d>(by_odom.target).y(), 2.0, 1e-12);
  EXPECT_NEAR(*by_odom.heading_rad, 0.5 + std::numbers::pi / 2.0, 1e-12);
  EXPECT_THROW(to_goal(pose_in("odom", {}), frames, {}, {}), std::invalid_argument);
  EXPECT_THROW(to_goal(pose_in("camera", {}), frames, T_map_odom, {}), std::invalid_argument);
}

TEST(RosOrders, AQuaternionOfNoLengthIsNoHeading) {
  ros::PoseStamped message = pose_in("map", {1.0, 1.0, 0.0});
  message.pose_().orientation_(ros::Quaternion());
  EXPECT_FALSE(to_goal(message, {}, {}, {}).heading_rad);
  message.pose_().position_().x_(NAN);
  EXPECT_THROW(to_goal(message, {}, {}, {}), std::invalid_argument);
}

// A goal that is finite in its own frame may be infinite in the map frame.
TEST(RosOrders, AGoalIsNotFartherThanAnyRobotGets) {
  EXPECT_THROW(
      to_goal(pose_in("odom", {1.7e308, 1.7e308, 0.0}), {}, geometry::Pose2{0.0, 0.0, 0.8}, {}),
      std::invalid_argument);
}

TEST(RosOrders, AVelocityIsAlongXAndAboutZ) {
  ros::Twist twist;
  twist.linear_().x_(0.4);
  twist.angular_().z_(-0.2);
  const msg::MotionCommand command = to_motion(twist);
  EXPECT_EQ(command.linear_mps(), 0.4);
  EXPECT_EQ(command.angular_radps(), -0.2);
  EXPECT_EQ(command.valid_for_s(), kLongestVelocity_s);
  for (const double other : {0.1, -0.1, static_cast<double>(NAN)}) {
    ros::Twist bad = twist;
    bad.linear_().y_(other);
    EXPECT_THROW(to_motion(bad), std::invalid_argument) << other;
    bad = twist;
    bad.angular_().y_(other);
    EXPECT_THROW(to_motion(bad), std::invalid_argument) << other;
  }
  twist.linear_().x_(INFINITY);
  EXPECT_THROW(to_motion(twist), std::invalid_argument);
}

TEST(RosOrders, APoseThatIsSetKeepsItsCovarianceWhereItHasOne) {
  ros::PoseWithCovarianceStamped message;
  message.header_(ros::header_of("map", 0));
  message.pose_().pose_(ros::pose_of({1.0, 2.0, 0.3}));
  const service::LocalizationCommand click = to_set_pose(message, "map");
  EXPECT_NEAR(click.T_map_robot.theta_rad, 0.3, 1e-12);
  EXPECT_NEAR(click.covariance(0, 0), 0.25, 1e-12);
  message.pose_().covariance_()[0] = 0.04;
  message.pose_().covariance_()[7] = 0.09;
  message.pose_().covariance_()[35] = 0.01;
  EXPECT_NEAR(to_set_pose(message, "map").covariance(1, 1), 0.09, 1e-12);
  message.pose_().covariance_()[0] = NAN;
  EXPECT_NEAR(to_set_pose(message, "map").covariance(0, 0), 0.25, 1e-12);
  message.header_().frame_id_("odom");
  EXPECT_THROW(to_set_pose(message, "map"), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::ros_bridge
