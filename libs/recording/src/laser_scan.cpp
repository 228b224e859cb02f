#include "topogeo/recording/laser_scan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "topogeo/scan/carmen_log_reader.hpp"

namespace topogeo::recording {
namespace {

constexpr std::size_t kMostBeams = scan::CarmenLogReader::kMaxBeams;
// As CARMEN logs are read: a full turn with a rounded step, a hundredth of the finest laser's step.
constexpr double kTurn_rad = 2.0 * std::numbers::pi + 0.01;
constexpr double kFinest_rad = 1e-5;
constexpr std::int64_t kSecond_ns = 1'000'000'000;

double rounded_to(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;  // no -0
}

std::optional<geometry::Pose2> planar(double x, double y, const ros::Quaternion& q) {
  const double norm2 = q.x_() * q.x_() + q.y_() * q.y_() + q.z_() * q.z_() + q.w_() * q.w_();
  if (!std::isfinite(x) || !std::isfinite(y) || !std::isfinite(norm2) || norm2 < 1e-12) {
    return std::nullopt;
  }
  const double sine = 2.0 * (q.w_() * q.z_() + q.x_() * q.y_());
  const double cosine = q.w_() * q.w_() + q.x_() * q.x_() - q.y_() * q.y_() - q.z_() * q.z_();
  return geometry::Pose2{x, y, geometry::wrap_angle(std::atan2(sine, cosine))};
}

void check_angles(const ros::LaserScan& message) {
  const double step_rad = std::fabs(static_cast<double>(message.angle_increment_()));
  const std::size_t beams = message.ranges_().size();
  if (beams < 2) {
    throw std::invalid_argument("expected 2 ranges or more, got " + std::to_string(beams));
  }
  if (!(std::fabs(static_cast<double>(message.angle_min_())) <= kTurn_rad) ||
      !(step_rad >= kFinest_rad) || !(step_rad * static_cast<double>(beams - 1) <= kTurn_rad)) {
    throw std::invalid_argument(
        "expected angle_min and a step of 0.00001 or more, within one turn, got " +
        std::to_string(message.angle_min_()) + " and " + std::to_string(beams) + " times " +
        std::to_string(message.angle_increment_()));
  }
}

}  // namespace

LaserMounting planar_mounting(const Eigen::Isometry3d& T_robot_laser) {
  const Eigen::Matrix3d R = T_robot_laser.linear();
  const Eigen::Vector3d t = T_robot_laser.translation();
  LaserMounting mounting;
  mounting.T_robot_laser = {rounded_to(t.x(), 1e4), rounded_to(t.y(), 1e4),
                            rounded_to(std::atan2(R(1, 0), R(0, 0)), 1e5)};
  mounting.upside_down = R(2, 2) < 0.0;
  mounting.tilt_rad = std::acos(std::clamp(std::fabs(R(2, 2)), 0.0, 1.0));
  return mounting;
}

scan::Scan to_scan(const ros::LaserScan& message, bool upside_down, double range_limit_m) {
  check_angles(message);
  const std::vector<float>& ranges = message.ranges_();
  const std::size_t every = (ranges.size() + kMostBeams - 1) / kMostBeams;
  const std::size_t beams = (ranges.size() + every - 1) / every;
  const double turn = upside_down ? -1.0 : 1.0;
  const double first_rad = turn * static_cast<double>(message.angle_min_());
  const double step_rad =
      turn * static_cast<double>(message.angle_increment_()) * static_cast<double>(every);
  const bool clockwise = step_rad < 0.0;

  const float least_m = message.range_min_();
  float limit_m = static_cast<float>(range_limit_m);
  if (message.range_max_() > least_m && message.range_max_() > 0.0F) {
    limit_m = std::min(limit_m, message.range_max_());
  }
  scan::Scan scan;
  scan.angle_step_rad = std::fabs(step_rad);
  scan.angle_min_rad =
      clockwise ? first_rad + static_cast<double>(beams - 1) * step_rad : first_rad;
  scan.ranges_m.reserve(beams);
  for (std::size_t i = 0; i < beams; ++i) {
    const float range_m = ranges[(clockwise ? beams - 1 - i : i) * every];
    const bool echo = range_m > 0.0F && range_m < limit_m && !(range_m < least_m);
    scan.ranges_m.push_back(echo ? range_m : scan::Scan::kNoReturn);
  }
  return scan;
}

ros::LaserScan from_scan(const scan::Scan& scan, const std::string& frame_id) {
  constexpr float kFarthest_m = 100.0F;  // beyond what lasers of this kind measure
  ros::LaserScan message;
  message.header_().stamp_(from_stamp_ns(scan.stamp_ns));
  message.header_().frame_id_(frame_id);
  message.angle_min_(static_cast<float>(scan.angle_min_rad));
  message.angle_increment_(static_cast<float>(scan.angle_step_rad));
  message.angle_max_(static_cast<float>(
      scan.angle_min_rad + static_cast<double>(scan.ranges_m.size() - 1) * scan.angle_step_rad));
  float farthest_m = kFarthest_m;
  message.ranges_().reserve(scan.ranges_m.size());
  for (const float range_m : scan.ranges_m) {
    const bool echo = range_m != scan::Scan::kNoReturn;
    message.ranges_().push_back(echo ? range_m : std::numeric_limits<float>::infinity());
    if (echo) farthest_m = std::max(farthest_m, 2.0F * range_m);
  }
  message.range_max_(farthest_m);
  return message;
}

std::optional<geometry::Pose2> planar_pose(const ros::Pose& pose) {
  return planar(pose.position_().x_(), pose.position_().y_(), pose.orientation_());
}

std::optional<geometry::Pose2> planar_pose(const ros::Transform& transform) {
  return planar(transform.translation_().x_(), transform.translation_().y_(),
                transform.rotation_());
}

ros::Quaternion to_quaternion(double yaw_rad) {
  ros::Quaternion quaternion;
  quaternion.z_(std::sin(yaw_rad / 2.0));
  quaternion.w_(std::cos(yaw_rad / 2.0));
  return quaternion;
}

Eigen::Isometry3d to_isometry(const ros::Transform& transform) {
  const ros::Vector3& t = transform.translation_();
  const ros::Quaternion& q = transform.rotation_();
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() =
      Eigen::Quaterniond(q.w_(), q.x_(), q.y_(), q.z_()).normalized().toRotationMatrix();
  isometry.translation() = Eigen::Vector3d(t.x_(), t.y_(), t.z_());
  return isometry;
}

std::int64_t to_stamp_ns(const ros::Time& time) {
  // Seconds of ROS 1 have no sign; those of ROS 2 are not negative in any recording of this
  // century.
  return std::int64_t{static_cast<std::uint32_t>(time.sec_())} * kSecond_ns + time.nanosec_();
}

ros::Time from_stamp_ns(std::int64_t stamp_ns) {
  if (stamp_ns < 0 || stamp_ns / kSecond_ns > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("stamp: expected seconds in 32 bits, got " +
                                std::to_string(stamp_ns) + " ns");
  }
  ros::Time time;
  time.sec_(static_cast<std::int32_t>(static_cast<std::uint32_t>(stamp_ns / kSecond_ns)));
  time.nanosec_(static_cast<std::uint32_t>(stamp_ns % kSecond_ns));
  return time;
}

std::string frame_name(const std::string& frame_id) {
  return frame_id.starts_with('/') ? frame_id.substr(1) : frame_id;
}

}  // namespace topogeo::recording
