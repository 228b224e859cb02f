#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/slam/state_monitor.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;

namespace {

/// Probability of a normal distribution within the bounds of msg::LivePose. Position and heading
/// are taken as independent, and the position as equally uncertain in all directions, as in the
/// worst.
double confidence_of(const Eigen::Matrix3d& covariance) {
  constexpr double kWithin_m = 0.3;
  constexpr double kWithin_rad = 5.0 * std::numbers::pi / 180.0;
  const double half_trace = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double spread = std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  const double variance_m2 = half_trace + spread;
  const double variance_rad2 = covariance(2, 2);
  if (!(variance_m2 > 0.0) || !(variance_rad2 > 0.0)) return 1.0;
  return (1.0 - std::exp(-0.5 * kWithin_m * kWithin_m / variance_m2)) *
         std::erf(kWithin_rad / std::sqrt(2.0 * variance_rad2));
}

}  // namespace

navigation::PoseFix to_pose_fix(const LivePose& pose) {
  navigation::PoseFix fix;
  fix.stamp_ns = pose.stamp_ns;
  fix.T_map_robot = pose.T_map_robot;
  // While mapping, the covariance is relative to the first stop, not to the map around the robot.
  if (pose.mode != msg::kModeMapping) fix.covariance = pose.covariance;
  fix.tracking = pose.status.state == localization::LocalizationState::kTracking;
  fix.located = localization::located(pose.status.state);
  fix.place_known =
      pose.mode != msg::kModeMapping && localization::place_is_known(pose.status, pose.covariance);
  fix.state_text = localization::to_string(pose.status.state);
  return fix;
}

LivePose to_live_pose(const navigation::PoseFix& fix, std::uint64_t sequence) {
  using localization::LocalizationState;
  LivePose pose;
  pose.stamp_ns = fix.stamp_ns;
  pose.sequence = sequence;
  pose.mode = msg::kModeMarkov;
  pose.T_map_robot = fix.T_map_robot;
  pose.covariance = fix.covariance;
  pose.status.state = fix.tracking ? LocalizationState::kTracking : LocalizationState::kSearching;
  if (fix.tracking) pose.status.confidence = confidence_of(fix.covariance);
  return pose;
}

navigation::OdometrySample odometry_from_msg(const msg::Odometry& message) {
  return {message.stamp_ns(), from_msg(message.T_odom_robot())};
}

navigation::ScanPoints to_scan_points(const scan::Scan& scan,
                                      const geometry::Pose2& T_robot_laser) {
  navigation::ScanPoints out;
  out.stamp_ns = scan.stamp_ns;
  out.T_odom_robot = scan.T_odom_robot;
  out.T_robot_laser = T_robot_laser;
  out.scan = std::make_shared<const scan::Scan>(scan);
  out.points_m.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (scan.ranges_m[i] <= scan::Scan::kNoReturn) continue;
    const double angle_rad = scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad;
    const geometry::SinCos direction = geometry::sincos(angle_rad);
    const auto range_m = static_cast<double>(scan.ranges_m[i]);
    out.points_m.push_back(T_robot_laser *
                           Eigen::Vector2d(range_m * direction.cos, range_m * direction.sin));
  }
  return out;
}

navigation::SonarRound sonar_from_msg(const msg::Sonar& message) {
  check_bound("echoes", message.echoes().size(), msg::kMaxSonars);
  navigation::SonarRound out;
  out.stamp_ns = message.stamp_ns();
  for (const msg::SonarEcho& echo : message.echoes()) {
    const auto half_cone_rad = static_cast<double>(echo.half_cone_rad());
    check(half_cone_rad > 0.0 && half_cone_rad <= std::numbers::pi, "echoes.half_cone_rad",
          "more than 0, at most pi");
    check(std::isfinite(echo.range_m()) && echo.range_m() >= 0.0F, "echoes.range_m", "0 or more");
    out.readings.push_back({from_msg(echo.T_robot_sonar()), half_cone_rad, echo.range_m()});
  }
  return out;
}

navigation::BaseCondition base_from_msg(const msg::BaseStatus& message) {
  return {message.stamp_ns(), message.commands_taken(), message.reason().to_string()};
}

msg::NavigatorStatus to_msg(const navigation::NavigatorStatus& status, std::string_view robot_id,
                            std::int64_t stamp_ns, std::uint64_t sequence_number) {
  msg::NavigatorStatus out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.state(static_cast<msg::NavigatorState>(status.state));  // same values, see the IDL
  out.reason(static_cast<msg::HaltReason>(status.reason));
  messaging::set_text_cut(out.message(), status.message);
  out.goal_id(status.goal_id);
  out.driven_m(status.driven_m);
  out.rest_m(status.rest_m);
  out.rest_s(status.rest_s);
  out.pose_known(status.T_map_robot.has_value());
  out.T_map_robot(to_msg(status.T_map_robot.value_or(geometry::Pose2{})));
  out.linear_mps(status.command.linear_m_per_s);
  out.angular_radps(status.command.angular_rad_per_s);
  out.free_ahead_m(status.free_ahead_m);
  out.detours(status.detours);
  out.routes(status.routes);
  out.branch_detours(status.branch_detours);
  out.virtual_detours(status.virtual_detours);
  out.guard_stops(status.guard_stops);
  return out;
}

bool goal_has_ended(const msg::NavigatorStatus& message) {
  return message.state() == msg::kNavigatorIdle || message.state() == msg::kNavigatorArrived;
}

navigation::NavigatorStatus from_msg(const msg::NavigatorStatus& message) {
  check(message.state() <= msg::kNavigatorStopped, "state", "0 to 5");
  check(message.reason() <= msg::kHaltBaseStuck, "reason", "0 to 13");
  navigation::NavigatorStatus out;
  out.state = static_cast<navigation::NavigatorState>(message.state());
  out.reason = static_cast<navigation::HaltReason>(message.reason());
  out.message = message.message().to_string();
  out.goal_id = message.goal_id();
  out.driven_m = finite(message.driven_m(), "driven_m");
  out.rest_m = finite(message.rest_m(), "rest_m");
  out.rest_s = finite(message.rest_s(), "rest_s");
  if (message.pose_known()) out.T_map_robot = from_msg(message.T_map_robot());
  out.command = {finite(message.linear_mps(), "linear_mps"),
                 finite(message.angular_radps(), "angular_radps")};
  out.free_ahead_m = finite(message.free_ahead_m(), "free_ahead_m");
  out.detours = message.detours();
  out.routes = message.routes();
  out.branch_detours = message.branch_detours();
  out.virtual_detours = message.virtual_detours();
  out.guard_stops = message.guard_stops();
  return out;
}

msg::Blockages to_msg(const navigation::BlockageReport& report, std::string_view robot_id,
                      std::int64_t stamp_ns, std::uint64_t sequence_number) {
  check_bound("points", report.points_m.size(), msg::kMaxBlockedPoints);
  msg::Blockages out;
  messaging::set_header(out, robot_id, stamp_ns, sequence_number);
  out.version(report.version);
  out.points().reserve(report.points_m.size());
  for (const Eigen::Vector2d& point_m : report.points_m) {
    out.points().push_back(detail::to_point(point_m));
  }
  return out;
}

navigation::BlockageReport from_msg(const msg::Blockages& message) {
  check_bound("points", message.points().size(), msg::kMaxBlockedPoints);
  navigation::BlockageReport out;
  out.version = message.version();
  out.points_m.reserve(message.points().size());
  for (const msg::Point2& point : message.points()) {
    out.points_m.emplace_back(finite(point.x_m(), "points"), finite(point.y_m(), "points"));
  }
  return out;
}

}  // namespace topogeo::service
