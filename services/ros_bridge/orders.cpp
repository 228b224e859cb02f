#include "orders.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Cholesky>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr double kClick_m = 0.5;
constexpr double kClick_rad = 15.0 * std::numbers::pi / 180.0;
/// Tolerance for a speed that is zero up to rounding.
constexpr double kNothing = 1e-6;

geometry::Pose2 map_from(const std::string& frame, const Settings::Frames& frames,
                         const std::optional<geometry::Pose2>& T_map_odom,
                         const std::optional<geometry::Pose2>& T_map_robot) {
  if (frame == frames.map) return {};
  if (frame == frames.odom && T_map_odom) return *T_map_odom;
  if (frame == (frames.robot.empty() ? "base_link" : frames.robot) && T_map_robot) {
    return *T_map_robot;
  }
  throw std::invalid_argument("frame '" + frame + "': expected " + frames.map);
}

}  // namespace

service::Goal to_goal(const ros::PoseStamped& message, const Settings::Frames& frames,
                      const std::optional<geometry::Pose2>& T_map_odom,
                      const std::optional<geometry::Pose2>& T_map_robot) {
  const geometry::Pose2 T_map_frame =
      map_from(ros::frame_name(message.header_().frame_id_()), frames, T_map_odom, T_map_robot);
  const Eigen::Vector2d at_m(message.pose_().position_().x_(), message.pose_().position_().y_());
  if (!(at_m.cwiseAbs().array() <= ros::kFarthest_m).all()) {
    throw std::invalid_argument("position: expected numbers up to 1e8");
  }
  service::Goal goal;
  goal.kind = msg::kGoalPosition;
  goal.target = Eigen::Vector2d(T_map_frame * at_m);
  if (const auto pose = ros::planar(message.pose_())) {
    goal.heading_rad = geometry::wrap_angle(T_map_frame.theta_rad + pose->theta_rad);
  }
  return goal;
}

service::LocalizationCommand to_set_pose(const ros::PoseWithCovarianceStamped& message,
                                         const std::string& map_frame) {
  const std::string frame = ros::frame_name(message.header_().frame_id_());
  if (frame != map_frame) {
    throw std::invalid_argument("frame '" + frame + "': expected " + map_frame);
  }
  const auto pose = ros::planar(message.pose_().pose_());
  if (!pose)
    throw std::invalid_argument("pose: expected numbers up to 1e8 and a quaternion of length 1");
  service::LocalizationCommand command;
  command.kind = msg::kCommandSetPose;
  command.T_map_robot = *pose;
  command.covariance = ros::planar_covariance(message.pose_().covariance_());
  constexpr double kLeast = 1e-12;
  const Eigen::LLT<Eigen::Matrix3d> factor(command.covariance);
  if (!command.covariance.allFinite() || factor.info() != Eigen::Success ||
      command.covariance.diagonal().minCoeff() < kLeast) {
    command.covariance =
        Eigen::Vector3d(kClick_m * kClick_m, kClick_m * kClick_m, kClick_rad * kClick_rad)
            .asDiagonal();
  }
  return command;
}

msg::MotionCommand to_motion(const ros::Twist& twist) {
  const double linear_mps = twist.linear_().x_();
  const double angular_radps = twist.angular_().z_();
  if (!std::isfinite(linear_mps) || !std::isfinite(angular_radps)) {
    throw std::invalid_argument("expected finite speeds");
  }
  for (const double other :
       {twist.linear_().y_(), twist.linear_().z_(), twist.angular_().x_(), twist.angular_().y_()}) {
    if (!(std::fabs(other) < kNothing)) {
      throw std::invalid_argument("expected only linear.x and angular.z");
    }
  }
  msg::MotionCommand command;
  command.linear_mps(linear_mps);
  command.angular_radps(angular_radps);
  command.valid_for_s(kLongestVelocity_s);
  return command;
}

}  // namespace topogeo::ros_bridge
