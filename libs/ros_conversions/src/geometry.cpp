#include "topogeo/ros_conversions/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace topogeo::ros {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr double kShortestQuaternion = 1e-3;
/// Indices of x, y and heading among x, y, z and the rotations about them.
constexpr std::array<std::size_t, 3> kPlanarRows = {0, 1, 5};
/// Variance of height, roll and pitch, which are constant on a floor; not zero, so that the matrix
/// can be inverted.
constexpr double kFlatVariance = 1e-6;

/// Eigen's indices are signed.
double& cell(Eigen::Matrix3d& matrix, std::size_t row, std::size_t column) {
  return matrix(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
}

std::optional<geometry::Pose2> seen_from_above(double x_m, double y_m, const Quaternion& q) {
  const double norm2 = q.x_() * q.x_() + q.y_() * q.y_() + q.z_() * q.z_() + q.w_() * q.w_();
  if (!(std::fabs(x_m) <= kFarthest_m) || !(std::fabs(y_m) <= kFarthest_m) ||
      !std::isfinite(norm2) || norm2 < kShortestQuaternion * kShortestQuaternion) {
    return std::nullopt;
  }
  const double sine = 2.0 * (q.w_() * q.z_() + q.x_() * q.y_());
  const double cosine = q.w_() * q.w_() + q.x_() * q.x_() - q.y_() * q.y_() - q.z_() * q.z_();
  return geometry::Pose2{x_m, y_m, geometry::wrap_angle(std::atan2(sine, cosine))};
}

}  // namespace

std::int64_t stamp_ns_of(const Time& time) {
  return std::int64_t{static_cast<std::uint32_t>(time.sec_())} * kSecond_ns + time.nanosec_();
}

Time time_of(std::int64_t stamp_ns) {
  if (stamp_ns < 0 || stamp_ns / kSecond_ns > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("stamp: expected seconds in 32 bits, got " +
                                std::to_string(stamp_ns) + " ns");
  }
  Time time;
  time.sec_(static_cast<std::int32_t>(static_cast<std::uint32_t>(stamp_ns / kSecond_ns)));
  time.nanosec_(static_cast<std::uint32_t>(stamp_ns % kSecond_ns));
  return time;
}

std::int64_t usable_stamp_ns(std::int64_t stamp_ns) {
  constexpr std::int64_t kFirstTooLate_ns =
      (std::int64_t{std::numeric_limits<std::uint32_t>::max()} + 1) * kSecond_ns;
  return std::clamp<std::int64_t>(stamp_ns, 0, kFirstTooLate_ns - 11 * kSecond_ns);
}

std::string frame_name(const std::string& frame_id) {
  return frame_id.starts_with('/') ? frame_id.substr(1) : frame_id;
}

Header header_of(const std::string& frame, std::int64_t stamp_ns) {
  Header header;
  header.frame_id_(frame);
  header.stamp_(time_of(stamp_ns));
  return header;
}

Quaternion rotation_of(double yaw_rad) {
  Quaternion rotation;
  rotation.z_(std::sin(yaw_rad / 2.0));
  rotation.w_(std::cos(yaw_rad / 2.0));
  return rotation;
}

Point point_of(const Eigen::Vector2d& point_m) {
  Point point;
  point.x_(point_m.x());
  point.y_(point_m.y());
  return point;
}

Pose pose_of(const geometry::Pose2& pose) {
  Pose out;
  out.position_(point_of(pose.position_m()));
  out.orientation_(rotation_of(pose.theta_rad));
  return out;
}

TransformStamped transform_of(const std::string& parent, const std::string& child,
                              const geometry::Pose2& T_parent_child, std::int64_t stamp_ns) {
  TransformStamped out;
  out.header_(header_of(parent, stamp_ns));
  out.child_frame_id_(child);
  out.transform_().translation_().x_(T_parent_child.x_m);
  out.transform_().translation_().y_(T_parent_child.y_m);
  out.transform_().rotation_(rotation_of(T_parent_child.theta_rad));
  return out;
}

PoseWithCovarianceStamped pose_of(const std::string& frame, std::int64_t stamp_ns,
                                  const geometry::Pose2& pose, const Eigen::Matrix3d& covariance) {
  PoseWithCovarianceStamped out;
  out.header_(header_of(frame, stamp_ns));
  out.pose_().pose_(pose_of(pose));
  std::array<double, 36> rows{};
  for (const std::size_t flat : {2U, 3U, 4U}) rows[flat * 6 + flat] = kFlatVariance;
  Eigen::Matrix3d from = covariance;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      rows[kPlanarRows[i] * 6 + kPlanarRows[j]] = cell(from, i, j);
    }
  }
  out.pose_().covariance_(rows);
  return out;
}

Eigen::Matrix3d planar_covariance(const std::array<double, 36>& covariance) {
  Eigen::Matrix3d out;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      cell(out, i, j) = 0.5 * (covariance[kPlanarRows[i] * 6 + kPlanarRows[j]] +
                               covariance[kPlanarRows[j] * 6 + kPlanarRows[i]]);
    }
  }
  return out;
}

std::optional<geometry::Pose2> planar(const Pose& pose) {
  return seen_from_above(pose.position_().x_(), pose.position_().y_(), pose.orientation_());
}

std::optional<geometry::Pose2> planar(const Transform& transform) {
  return seen_from_above(transform.translation_().x_(), transform.translation_().y_(),
                         transform.rotation_());
}

std::optional<Eigen::Isometry3d> isometry_of(const Transform& transform) {
  const Vector3& t = transform.translation_();
  const Quaternion& q = transform.rotation_();
  const Eigen::Quaterniond rotation(q.w_(), q.x_(), q.y_(), q.z_());
  const Eigen::Vector3d offset_m(t.x_(), t.y_(), t.z_());
  if (!planar(transform) || !(std::fabs(t.z_()) <= kFarthest_m)) return std::nullopt;
  Eigen::Isometry3d isometry = Eigen::Isometry3d::Identity();
  isometry.linear() = rotation.normalized().toRotationMatrix();
  isometry.translation() = offset_m;
  return isometry;
}

}  // namespace topogeo::ros
