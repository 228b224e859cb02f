#include "topogeo/scan/laser_mounting.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "carmen_line.hpp"
#include "gz_lines.hpp"
#include "motion_mounting.hpp"

namespace topogeo::scan {
namespace {

using geometry::Pose2;

constexpr std::size_t kFewestPoses = 10;  // fewer agree by chance
constexpr double kFarthest_m = 5.0;       // beyond it, the frame is not that of a robot
constexpr double kSamePlace_m = 0.01;     // logs with two digits round by up to half of it
constexpr double kSameHeading_rad = 0.5 * std::numbers::pi / 180.0;
constexpr double kAgreeing = 0.9;  // required share of the poses
// A standing robot repeats one pose, which agrees with itself in any frame.
constexpr double kMoved_m = 0.02;
constexpr double kMoved_rad = 0.02;

template <typename Value>
double median_of(std::span<const Pose2> poses, Value value) {
  std::vector<double> values;
  values.reserve(poses.size());
  for (const Pose2& pose : poses) values.push_back(value(pose));
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double rounded(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;  // no -0
}

bool near(const Pose2& a, const Pose2& b, double place_m, double heading_rad) {
  const Eigen::Vector3d apart = difference(a, b);
  return apart.head<2>().norm() <= place_m && std::fabs(apart.z()) <= heading_rad;
}

}  // namespace

std::optional<Pose2> common_mounting(std::span<const Pose2> T_robot_laser) {
  if (T_robot_laser.size() < kFewestPoses) return std::nullopt;
  // Uses sine and cosine, because the headings of a laser that looks back are at both ends of the
  // range.
  const double sine =
      median_of(T_robot_laser, [](const Pose2& pose) { return std::sin(pose.theta_rad); });
  const double cosine =
      median_of(T_robot_laser, [](const Pose2& pose) { return std::cos(pose.theta_rad); });
  const Pose2 common{
      rounded(median_of(T_robot_laser, [](const Pose2& pose) { return pose.x_m; }), 1e4),
      rounded(median_of(T_robot_laser, [](const Pose2& pose) { return pose.y_m; }), 1e4),
      rounded(std::atan2(sine, cosine), 1e5)};
  const auto agreeing = std::ranges::count_if(T_robot_laser, [&](const Pose2& pose) {
    return near(pose, common, kSamePlace_m, kSameHeading_rad);
  });
  if (static_cast<double>(agreeing) < kAgreeing * static_cast<double>(T_robot_laser.size()) ||
      std::fabs(common.x_m) > kFarthest_m || std::fabs(common.y_m) > kFarthest_m) {
    return std::nullopt;
  }
  return common;
}

std::optional<Pose2> mounting_in_log(const std::filesystem::path& log) {
  GzLines lines(log);
  GzLines::Line line;
  CarmenLineParser parser(kFarthest_m);  // reads no ranges
  std::vector<Pose2> mountings;
  MotionMounting motions;
  std::optional<Pose2> last;  // of the robot
  while (lines.next(line)) {
    if (line.too_long || line_kind(line.text) != LineKind::kLaser) continue;
    const auto poses = parser.parse_poses(line.text);
    if (!poses || (last && near(poses->T_odom_robot, *last, kMoved_m, kMoved_rad))) continue;
    last = poses->T_odom_robot;
    mountings.push_back(between(poses->T_odom_robot, poses->T_odom_laser));
    motions.add(*poses);
  }
  if (const std::optional<Pose2> common = common_mounting(mountings)) return common;
  const std::optional<Pose2> found = motions.find();
  if (!found || std::hypot(found->x_m, found->y_m) > kFarthest_m) return std::nullopt;
  return Pose2{rounded(found->x_m, 1e3), rounded(found->y_m, 1e3), rounded(found->theta_rad, 1e3)};
}

}  // namespace topogeo::scan
