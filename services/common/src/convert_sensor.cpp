#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;

msg::Pose2 to_msg(const geometry::Pose2& pose) {
  msg::Pose2 out;
  out.x_m(pose.x_m);
  out.y_m(pose.y_m);
  out.theta_rad(pose.theta_rad);
  return out;
}

geometry::Pose2 from_msg(const msg::Pose2& pose) {
  return {finite(pose.x_m(), "x_m"), finite(pose.y_m(), "y_m"),
          finite(pose.theta_rad(), "theta_rad")};
}

msg::Matrix3 to_msg(const Eigen::Matrix3d& matrix) {
  msg::Matrix3 out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    out.at(i) = matrix(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  }
  return out;
}

Eigen::Matrix3d from_msg(const msg::Matrix3& matrix) {
  Eigen::Matrix3d out;
  for (std::size_t i = 0; i < matrix.size(); ++i) {
    out(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
        finite(matrix.at(i), "matrix");
  }
  return out;
}

msg::Scan to_msg(const scan::Scan& scan, std::string_view robot_id) {
  check_bound("ranges_m", scan.ranges_m.size(), msg::kMaxBeams);
  msg::Scan out;
  messaging::set_header(out, robot_id, scan.stamp_ns, scan.sequence);
  out.angle_min_rad(scan.angle_min_rad);
  out.angle_step_rad(scan.angle_step_rad);
  out.ranges_m(scan.ranges_m);
  out.T_odom_robot(to_msg(scan.T_odom_robot));
  out.odometry_epoch(scan.odometry_epoch);
  return out;
}

scan::Scan from_msg(const msg::Scan& message) {
  check_bound("ranges_m", message.ranges_m().size(), msg::kMaxBeams);
  check(!message.ranges_m().empty(), "ranges_m", "at least one beam");
  scan::Scan out;
  out.sequence = message.sequence_number();
  out.stamp_ns = message.stamp_ns();
  out.angle_min_rad = finite(message.angle_min_rad(), "angle_min_rad");
  out.angle_step_rad = finite(message.angle_step_rad(), "angle_step_rad");
  check(out.angle_step_rad > 0.0, "angle_step_rad", "more than 0");
  for (const float range_m : message.ranges_m()) {
    check(finite(static_cast<double>(range_m), "ranges_m") >= 0.0, "ranges_m", "0 or more");
  }
  out.ranges_m = message.ranges_m();
  out.T_odom_robot = from_msg(message.T_odom_robot());
  out.odometry_epoch = message.odometry_epoch();
  return out;
}

}  // namespace topogeo::service
