#include "outputs.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "geometry.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr double kFlatVariance = 1e-6;
// diagnostic_msgs/DiagnosticStatus
constexpr std::uint8_t kOk = 0;
constexpr std::uint8_t kWarning = 1;
constexpr std::uint8_t kError = 2;
// visualization_msgs/Marker
constexpr std::int32_t kSphere = 2;
constexpr std::int32_t kLineStrip = 4;
constexpr std::int32_t kText = 9;
constexpr std::int32_t kDeleteAll = 3;

struct Color {
  float r = 0.0F;
  float g = 0.0F;
  float b = 0.0F;
};
constexpr Color kBranchColor{0.1F, 0.4F, 0.9F};
constexpr Color kVirtualColor{0.6F, 0.6F, 0.6F};
constexpr Color kNodeColor{0.9F, 0.3F, 0.1F};
constexpr Color kNameColor{0.1F, 0.1F, 0.1F};

ros::Marker marker(const char* name_space, std::int32_t id, std::int32_t type,
                   const ros::Header& header, const Color& color, double size_m) {
  ros::Marker out;
  out.header_(header);
  out.ns_(name_space);
  out.id_(id);
  out.type_(type);
  out.pose_().orientation_().w_(1.0);
  out.scale_().x_(size_m);
  out.scale_().y_(size_m);
  out.scale_().z_(size_m);
  out.color_().r_(color.r);
  out.color_().g_(color.g);
  out.color_().b_(color.b);
  out.color_().a_(1.0F);
  return out;
}

ros::MarkerArray cleared(const ros::Header& header) {
  ros::MarkerArray array;
  ros::Marker& all = array.markers_().emplace_back();
  all.header_(header);
  all.action_(kDeleteAll);
  all.pose_().orientation_().w_(1.0);
  return array;
}

ros::Marker name_marker(const char* name_space, std::int32_t id, const ros::Header& header,
                        const msg::Point2& at, const std::string& text) {
  constexpr double kLetter_m = 0.4;
  ros::Marker out = marker(name_space, id, kText, header, kNameColor, kLetter_m);
  out.pose_().position_().x_(at.x_m());
  out.pose_().position_().y_(at.y_m());
  out.text_(text);
  return out;
}

ros::Point point_at(double x_m, double y_m) {
  ros::Point point;
  point.x_(x_m);
  point.y_(y_m);
  return point;
}

}  // namespace

geometry::Pose2 correction_of(const geometry::Pose2& T_map_robot,
                              const geometry::Pose2& T_odom_robot) {
  return T_map_robot * inverse(T_odom_robot);
}

ros::PoseWithCovarianceStamped to_ros(const service::LivePose& pose, const std::string& frame) {
  ros::PoseWithCovarianceStamped out;
  out.header_(header_of(frame, pose.stamp_ns));
  out.pose_().pose_(to_ros(pose.T_map_robot));
  // Ours over x, y, yaw; theirs over x, y, z and the rotations about x, y, z.
  constexpr std::array<std::size_t, 3> kRows = {0, 1, 5};
  std::array<double, 36> covariance{};
  for (const std::size_t flat : {2U, 3U, 4U}) covariance[flat * 7] = kFlatVariance;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      covariance[kRows[row] * 6 + kRows[column]] =
          pose.covariance(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
    }
  }
  out.pose_().covariance_(covariance);
  return out;
}

ros::Path to_path(const msg::Route& route, const std::string& frame) {
  ros::Path path;
  path.header_(header_of(frame, route.stamp_ns()));
  if (route.status() != msg::kRouteFound) return path;
  double yaw_rad = 0.0;
  const auto& points = route.points();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i + 1 < points.size()) {
      yaw_rad =
          std::atan2(points[i + 1].y_m() - points[i].y_m(), points[i + 1].x_m() - points[i].x_m());
    } else if (route.has_heading()) {
      yaw_rad = route.heading_rad();
    }
    ros::PoseStamped pose;
    pose.header_(path.header_());
    pose.pose_(to_ros(geometry::Pose2{points[i].x_m(), points[i].y_m(), yaw_rad}));
    path.poses_().push_back(std::move(pose));
  }
  return path;
}

ros::Twist to_ros(double linear_mps, double angular_radps) {
  ros::Twist twist;
  twist.linear_().x_(linear_mps);
  twist.angular_().z_(angular_radps);
  return twist;
}

ros::LaserScan to_ros(const msg::Scan& scan, const std::string& frame, float longest_m) {
  ros::LaserScan out;
  out.header_(header_of(frame, scan.stamp_ns()));
  out.angle_min_(static_cast<float>(scan.angle_min_rad()));
  out.angle_increment_(static_cast<float>(scan.angle_step_rad()));
  out.angle_max_(static_cast<float>(scan.angle_min_rad() +
                                    scan.angle_step_rad() *
                                        (static_cast<double>(scan.ranges_m().size()) - 1.0)));
  out.range_max_(longest_m);
  out.ranges_(scan.ranges_m());
  for (float& range_m : out.ranges_()) {
    if (range_m == scan::Scan::kNoReturn) range_m = std::numeric_limits<float>::infinity();
  }
  return out;
}

ros::Odometry to_ros(const msg::Odometry& odometry, const std::string& odom,
                     const std::string& robot) {
  ros::Odometry out;
  out.header_(header_of(odom, odometry.stamp_ns()));
  out.child_frame_id_(robot);
  out.pose_().pose_(to_ros(service::from_msg(odometry.T_odom_robot())));
  out.twist_().twist_(to_ros(odometry.linear_mps(), odometry.angular_radps()));
  return out;
}

ros::MarkerArray graph_markers(const topomap::GlobalMap& map, const std::string& frame,
                               std::int64_t stamp_ns) {
  constexpr double kNode_m = 0.2;
  constexpr double kLine_m = 0.05;
  const ros::Header header = header_of(frame, stamp_ns);
  ros::MarkerArray array = cleared(header);
  for (const topomap::MapNode& node : map.nodes) {
    ros::Marker out =
        marker("nodes", static_cast<std::int32_t>(node.id), kSphere, header, kNodeColor, kNode_m);
    out.pose_().position_(point_at(node.position_m.x(), node.position_m.y()));
    array.markers_().push_back(std::move(out));
  }
  for (const topomap::MapBranch& branch : map.branches) {
    if (branch.points.size() < 2) continue;
    ros::Marker out = marker(branch.is_virtual ? "virtual_branches" : "branches",
                             static_cast<std::int32_t>(branch.id), kLineStrip, header,
                             branch.is_virtual ? kVirtualColor : kBranchColor, kLine_m);
    for (const topomap::BranchPoint& point : branch.points) {
      out.points_().push_back(point_at(point.position_m.x(), point.position_m.y()));
    }
    array.markers_().push_back(std::move(out));
  }
  return array;
}

ros::MarkerArray room_markers(const GridMirror& map, const std::string& frame,
                              std::int64_t stamp_ns) {
  const ros::Header header = header_of(frame, stamp_ns);
  ros::MarkerArray array = cleared(header);
  if (!map.has_map()) return array;
  const auto middles = map.zone_middles();
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const std::string name = map.summary().zones()[i].name().to_string();
    if (name.empty() || !middles[i]) continue;
    array.markers_().push_back(
        name_marker("rooms", static_cast<std::int32_t>(i), header, *middles[i], name));
  }
  std::int32_t id = 0;
  for (const msg::HybridPlace& place : map.summary().places()) {
    array.markers_().push_back(
        name_marker("places", id++, header, place.position(), place.name().to_string()));
  }
  return array;
}

ros::DiagnosticStatus to_ros(const msg::ServiceStatus& status) {
  ros::DiagnosticStatus out;
  const bool waits = status.state() == msg::kServiceStarting ||
                     status.state() == msg::kServiceWaiting || status.waits_for().size() > 0;
  out.level_(status.state() == msg::kServiceFailed ? kError : (waits ? kWarning : kOk));
  out.name_("topogeo: " + status.service().to_string());
  std::string text = status.message().to_string();
  if (status.waits_for().size() > 0) {
    text += (text.empty() ? "waits for " : "; waits for ") + status.waits_for().to_string();
  }
  out.message_(text);
  out.hardware_id_(status.robot_id().to_string());
  const auto add = [&](const std::string& key, const std::string& value) {
    auto& entry = out.values_().emplace_back();
    entry.key_(key);
    entry.value_(value);
  };
  add("host", status.host().to_string());
  add("faults", std::to_string(status.fault_count()));
  for (const msg::FaultCount& fault : status.faults()) {
    add("fault: " + fault.reason().to_string(), std::to_string(fault.count()));
  }
  for (const msg::FaultCount& drop : status.drops()) {
    add("dropped: " + drop.reason().to_string(), std::to_string(drop.count()));
  }
  if (status.inputs() > 0) {
    add(status.input().to_string() + " per second", std::to_string(status.input_rate_per_s()));
  }
  return out;
}

}  // namespace topogeo::ros_bridge
