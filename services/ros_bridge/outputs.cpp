#include "outputs.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"
#include "topogeo/ros_conversions/markers.hpp"

namespace topogeo::ros_bridge {
namespace {

// diagnostic_msgs/DiagnosticStatus
constexpr std::uint8_t kOk = 0;
constexpr std::uint8_t kWarning = 1;
constexpr std::uint8_t kError = 2;
}  // namespace

geometry::Pose2 correction_of(const geometry::Pose2& T_map_robot,
                              const geometry::Pose2& T_odom_robot) {
  return T_map_robot * inverse(T_odom_robot);
}

ros::PoseWithCovarianceStamped to_ros(const service::LivePose& pose, const std::string& frame) {
  return ros::pose_of(frame, pose.stamp_ns, pose.T_map_robot, pose.covariance);
}

ros::Path to_path(const msg::Route& route, const std::string& frame) {
  ros::Path path;
  path.header_(ros::header_of(frame, route.stamp_ns()));
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
    pose.pose_(ros::pose_of(geometry::Pose2{points[i].x_m(), points[i].y_m(), yaw_rad}));
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
  return ros::to_laser_scan(service::from_msg(scan), frame, longest_m);
}

ros::Odometry to_ros(const msg::Odometry& odometry, const std::string& odom,
                     const std::string& robot) {
  ros::Odometry out;
  out.header_(ros::header_of(odom, odometry.stamp_ns()));
  out.child_frame_id_(robot);
  out.pose_().pose_(ros::pose_of(service::from_msg(odometry.T_odom_robot())));
  out.twist_().twist_(to_ros(odometry.linear_mps(), odometry.angular_radps()));
  return out;
}

ros::MarkerArray graph_markers(const topomap::GlobalMap& map, const std::string& frame,
                               std::int64_t stamp_ns) {
  ros::GraphDrawing graph;
  for (const topomap::MapNode& node : map.nodes) {
    graph.nodes.push_back({static_cast<std::int32_t>(node.id), node.position_m});
  }
  for (const topomap::MapBranch& branch : map.branches) {
    ros::GraphDrawing::Branch& drawn = graph.branches.emplace_back();
    drawn.id = static_cast<std::int32_t>(branch.id);
    drawn.is_virtual = branch.is_virtual;
    for (const topomap::BranchPoint& point : branch.points) {
      drawn.points_m.push_back(point.position_m);
    }
  }
  return ros::graph_markers(graph, ros::header_of(frame, stamp_ns));
}

ros::MarkerArray room_markers(const GridMirror& map, const std::string& frame,
                              std::int64_t stamp_ns) {
  std::vector<ros::NameDrawing> names;
  if (map.has_map()) {
    const auto middles = map.zone_middles();
    for (std::size_t i = 0; i < middles.size(); ++i) {
      const std::string name = map.summary().zones()[i].name().to_string();
      if (name.empty() || !middles[i]) continue;
      names.push_back(
          {"rooms", static_cast<std::int32_t>(i), {middles[i]->x_m(), middles[i]->y_m()}, name});
    }
    std::int32_t id = 0;
    for (const msg::HybridPlace& place : map.summary().places()) {
      names.push_back({"places",
                       id++,
                       {place.position().x_m(), place.position().y_m()},
                       place.name().to_string()});
    }
  }
  return ros::name_markers(names, ros::header_of(frame, stamp_ns));
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
