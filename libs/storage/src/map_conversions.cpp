#include "map_conversions.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include "topogeo/support/format.hpp"

namespace topogeo::storage {
namespace {

template <typename... Args>
void require(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

double finite(double value, const char* what) {
  require(std::isfinite(value), "{} is not a finite number", what);
  return value;
}

topomap::NodeKind node_kind_from_proto(proto::NodeKind kind) {
  require(kind >= proto::NODE_KIND_REAL && kind <= proto::NODE_KIND_HALL_CORRIDOR,
          "node kind {}: expected 0 to 5", static_cast<int>(kind));
  return static_cast<topomap::NodeKind>(kind);
}

std::uint16_t group_from_proto(std::uint32_t group) {
  require(group <= std::numeric_limits<std::uint16_t>::max(),
          "generator group {}: expected 0 to {}", group, std::numeric_limits<std::uint16_t>::max());
  return static_cast<std::uint16_t>(group);
}

using PackedDoubles = google::protobuf::RepeatedField<double>;

void to_proto(const std::vector<topomap::BranchPoint>& points, PackedDoubles* out) {
  out->Reserve(static_cast<int>(3 * points.size()));
  for (const topomap::BranchPoint& p : points) {
    out->Add(p.position_m.x());
    out->Add(p.position_m.y());
    out->Add(p.clearance_m);
  }
}

std::vector<topomap::BranchPoint> branch_points_from_proto(const PackedDoubles& in) {
  require(in.size() % 3 == 0, "branch with {} numbers: expected three per point", in.size());
  require(in.size() >= 6, "branch with {} points: expected at least two", in.size() / 3);
  std::vector<topomap::BranchPoint> points;
  points.reserve(static_cast<std::size_t>(in.size() / 3));
  for (int i = 0; i < in.size(); i += 3) {
    points.push_back({{finite(in[i], "branch point"), finite(in[i + 1], "branch point")},
                      finite(in[i + 2], "branch clearance")});
  }
  return points;
}

void to_proto(const topomap::LocalNode& node, proto::LocalNode* out) {
  out->set_kind(static_cast<proto::NodeKind>(node.kind));
  out->set_x_m(node.position_m.x());
  out->set_y_m(node.position_m.y());
  out->set_clearance_m(node.clearance_m);
  for (const std::uint16_t group : node.base_groups) out->add_base_groups(group);
  out->set_in_main_graph(node.in_main_graph);
}

void to_proto(const topomap::LocalBranch& branch, proto::LocalBranch* out) {
  out->set_node_a(branch.node_a);
  out->set_node_b(branch.node_b);
  out->set_base_group_a(branch.base_groups[0]);
  out->set_base_group_b(branch.base_groups[1]);
  out->set_is_virtual(branch.is_virtual);
  out->set_in_main_graph(branch.in_main_graph);
  out->set_unconfirmed(!branch.confirmed);
  to_proto(branch.points, out->mutable_points());
}

topomap::LocalNode local_node_from_proto(const proto::LocalNode& in, std::uint32_t id) {
  topomap::LocalNode node;
  node.id = id;
  node.kind = node_kind_from_proto(in.kind());
  node.position_m = {finite(in.x_m(), "node position"), finite(in.y_m(), "node position")};
  node.clearance_m = finite(in.clearance_m(), "node clearance");
  for (const std::uint32_t group : in.base_groups()) {
    node.base_groups.push_back(group_from_proto(group));
  }
  node.in_main_graph = in.in_main_graph();
  return node;
}

topomap::LocalBranch local_branch_from_proto(const proto::LocalBranch& in, std::uint32_t id,
                                             std::size_t node_count) {
  require(in.node_a() < node_count && in.node_b() < node_count,
          "branch {} from node {} to node {}: expected less than {}", id, in.node_a(), in.node_b(),
          node_count);
  topomap::LocalBranch branch;
  branch.id = id;
  branch.node_a = in.node_a();
  branch.node_b = in.node_b();
  branch.base_groups = {group_from_proto(in.base_group_a()), group_from_proto(in.base_group_b())};
  branch.is_virtual = in.is_virtual();
  branch.in_main_graph = in.in_main_graph();
  branch.confirmed = !in.unconfirmed();
  branch.points = branch_points_from_proto(in.points());
  return branch;
}

void to_proto(const Eigen::Matrix3d& covariance, PackedDoubles* out) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out->Add(covariance(row, column));
  }
}

Eigen::Matrix3d covariance_from_proto(const PackedDoubles& in, const char* what) {
  require(in.size() == 9, "covariance with {} numbers: expected 9", in.size());
  Eigen::Matrix3d covariance;
  for (int i = 0; i < 9; ++i) covariance(i / 3, i % 3) = finite(in[i], what);
  return covariance;
}

topomap::TrackedScan tracked_scan_from_proto(const proto::TrackedScan& in) {
  return {in.sequence(), in.stamp_ns(), from_proto(in.t_odom_robot(), "T_odom_robot of a scan"),
          from_proto(in.t_stop_robot(), "T_stop_robot of a scan"), in.matched()};
}

}  // namespace

void to_proto(const geometry::Pose2& pose, proto::Pose2* out) {
  out->set_x_m(pose.x_m);
  out->set_y_m(pose.y_m);
  out->set_theta_rad(pose.theta_rad);
}

geometry::Pose2 from_proto(const proto::Pose2& in, const char* what) {
  return {finite(in.x_m(), what), finite(in.y_m(), what), finite(in.theta_rad(), what)};
}

void to_proto(const topomap::LocalMap& map, proto::LocalMap* out) {
  out->set_robot_id(map.robot_id);
  out->set_id(map.id);
  out->set_sequence(map.sequence);
  out->set_stamp_ns(map.stamp_ns);
  to_proto(map.T_odom_robot, out->mutable_t_odom_robot());
  to_proto(map.T_previous_robot, out->mutable_t_previous_robot());
  to_proto(map.T_robot_laser, out->mutable_t_robot_laser());
  for (const topomap::LocalNode& node : map.nodes) to_proto(node, out->add_nodes());
  for (const topomap::LocalBranch& branch : map.branches) to_proto(branch, out->add_branches());
  out->mutable_points()->Reserve(static_cast<int>(2 * map.points.size()));
  for (const topomap::ScanPoint& p : map.points) {
    out->add_points(p.x_m);
    out->add_points(p.y_m);
  }
  for (const topomap::TrackedScan& scan : map.track) {
    proto::TrackedScan* tracked = out->add_track();
    tracked->set_sequence(scan.sequence);
    tracked->set_stamp_ns(scan.stamp_ns);
    to_proto(scan.T_odom_robot, tracked->mutable_t_odom_robot());
    to_proto(scan.T_stop_robot, tracked->mutable_t_stop_robot());
    tracked->set_matched(scan.matched);
  }
  out->set_starts_drive(map.starts_drive);
  out->set_session(map.stop.session);
  out->set_number(map.stop.number);
  out->set_odometry_epoch(map.odometry_epoch);
}

topomap::LocalMap from_proto(const proto::LocalMap& in) {
  topomap::LocalMap map;
  map.robot_id = in.robot_id();
  map.id = in.id();
  map.sequence = in.sequence();
  map.stamp_ns = in.stamp_ns();
  map.T_odom_robot = from_proto(in.t_odom_robot(), "T_odom_robot of a stop");
  map.T_previous_robot = from_proto(in.t_previous_robot(), "T_previous_robot of a stop");
  map.T_robot_laser = from_proto(in.t_robot_laser(), "T_robot_laser");
  for (const proto::LocalNode& node : in.nodes()) {
    map.nodes.push_back(local_node_from_proto(node, static_cast<std::uint32_t>(map.nodes.size())));
  }
  for (const proto::LocalBranch& branch : in.branches()) {
    map.branches.push_back(local_branch_from_proto(
        branch, static_cast<std::uint32_t>(map.branches.size()), map.nodes.size()));
  }
  require(in.points_size() % 2 == 0, "scan points with {} numbers: expected two per point",
          in.points_size());
  for (int i = 0; i < in.points_size(); i += 2) {
    require(std::isfinite(in.points(i)) && std::isfinite(in.points(i + 1)),
            "scan point {} is not finite", i / 2);
    map.points.push_back({in.points(i), in.points(i + 1)});
  }
  for (const proto::TrackedScan& scan : in.track()) {
    map.track.push_back(tracked_scan_from_proto(scan));
  }
  map.starts_drive = in.starts_drive();
  map.stop = {in.session(), in.number()};
  map.odometry_epoch = in.odometry_epoch();
  return map;
}

void to_proto(const topomap::StopPose& stop, proto::StopPose* out) {
  out->set_local_map_id(stop.local_map_id);
  out->set_stamp_ns(stop.stamp_ns);
  to_proto(stop.T_map_robot, out->mutable_t_map_robot());
  to_proto(stop.covariance, out->mutable_covariance());
  out->set_not_located(!stop.located);
  out->set_more_views(stop.views - 1);
  out->set_last_view_ns(stop.last_view_ns);
}

topomap::StopPose from_proto(const proto::StopPose& in) {
  topomap::StopPose stop;
  stop.local_map_id = in.local_map_id();
  stop.stamp_ns = in.stamp_ns();
  stop.T_map_robot = from_proto(in.t_map_robot(), "pose of a stop");
  stop.covariance = covariance_from_proto(in.covariance(), "covariance of a stop");
  stop.located = !in.not_located();
  require(in.more_views() < std::numeric_limits<std::uint32_t>::max(), "{} more views of a stop",
          in.more_views());
  stop.views = in.more_views() + 1;
  stop.last_view_ns = in.last_view_ns();
  return stop;
}

void to_proto(const topomap::LoopClosure& closure, proto::LoopClosure* out) {
  out->set_earlier_id(closure.earlier_id);
  out->set_later_id(closure.later_id);
  to_proto(closure.T_earlier_later, out->mutable_t_earlier_later());
}

topomap::LoopClosure from_proto(const proto::LoopClosure& in) {
  return {in.earlier_id(), in.later_id(), from_proto(in.t_earlier_later(), "loop closure")};
}

void to_proto(const MapEdge& edge, proto::MapEdge* out) {
  out->set_earlier_id(edge.earlier_id);
  out->set_later_id(edge.later_id);
  to_proto(edge.T_earlier_later, out->mutable_t_earlier_later());
  to_proto(edge.covariance, out->mutable_covariance());
  out->set_kind(static_cast<proto::EdgeKind>(edge.kind));
}

MapEdge from_proto(const proto::MapEdge& in) {
  const auto kind = static_cast<MapEdge::Kind>(
      proto::EdgeKind_IsValid(in.kind()) ? in.kind() : proto::EDGE_UNKNOWN);
  return {in.earlier_id(), in.later_id(), from_proto(in.t_earlier_later(), "edge"),
          covariance_from_proto(in.covariance(), "covariance of an edge"), kind};
}

void to_proto(const topomap::MapNode& node, proto::MapNode* out) {
  out->set_id(node.id);
  out->set_kind(static_cast<proto::NodeKind>(node.kind));
  out->set_x_m(node.position_m.x());
  out->set_y_m(node.position_m.y());
  out->set_clearance_m(node.clearance_m);
  out->set_observations(node.observations);
  out->set_last_seen_ns(node.last_seen_ns);
}

topomap::MapNode from_proto(const proto::MapNode& in) {
  topomap::MapNode node;
  node.id = in.id();
  node.kind = node_kind_from_proto(in.kind());
  node.position_m = {finite(in.x_m(), "node position"), finite(in.y_m(), "node position")};
  node.clearance_m = finite(in.clearance_m(), "node clearance");
  node.observations = in.observations();
  node.last_seen_ns = in.last_seen_ns();
  return node;
}

void to_proto(const topomap::MapBranch& branch, proto::MapBranch* out) {
  out->set_id(branch.id);
  out->set_node_a(branch.node_a);
  out->set_node_b(branch.node_b);
  out->set_is_virtual(branch.is_virtual);
  out->set_observations(branch.observations);
  out->set_last_seen_ns(branch.last_seen_ns);
  to_proto(branch.points, out->mutable_points());
}

topomap::MapBranch from_proto(const proto::MapBranch& in) {
  topomap::MapBranch branch;
  branch.id = in.id();
  branch.node_a = in.node_a();
  branch.node_b = in.node_b();
  branch.is_virtual = in.is_virtual();
  branch.observations = in.observations();
  branch.last_seen_ns = in.last_seen_ns();
  branch.points = branch_points_from_proto(in.points());
  return branch;
}

std::string deterministic_bytes(const google::protobuf::MessageLite& message) {
  require(message.ByteSizeLong() <= static_cast<std::size_t>(std::numeric_limits<int>::max()),
          "map of {} bytes: Protobuf holds at most 2 GB", message.ByteSizeLong());
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    message.SerializeWithCachedSizes(&coded);
  }
  return bytes;
}

void to_proto(const RefusedMerge& refused, proto::RefusedMerge* out) {
  out->set_session(refused.stop.session);
  out->set_number(refused.stop.number);
  out->set_other_session(refused.other.session);
  out->set_other_number(refused.other.number);
}

RefusedMerge from_proto(const proto::RefusedMerge& in) {
  return {{in.session(), in.number()}, {in.other_session(), in.other_number()}};
}

}  // namespace topogeo::storage
