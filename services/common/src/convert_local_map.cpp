#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"

#include "convert.hpp"

namespace topogeo::service {

using detail::check;
using detail::check_bound;
using detail::finite;

namespace {

msg::LocalNode to_node(const topomap::LocalNode& node) {
  check_bound("nodes.base_groups", node.base_groups.size(), msg::kMaxBaseGroups);
  msg::LocalNode out;
  out.id(node.id);
  out.kind(detail::to_msg(node.kind));
  out.x_m(node.position_m.x());
  out.y_m(node.position_m.y());
  out.clearance_m(node.clearance_m);
  out.base_groups(node.base_groups);
  out.in_main_graph(node.in_main_graph);
  return out;
}

topomap::LocalNode from_node(const msg::LocalNode& node, std::size_t index) {
  check(node.id() == index, "nodes.id", "the index in nodes");
  topomap::LocalNode out;
  out.id = node.id();
  out.kind = detail::from_msg(node.kind());
  out.position_m = {finite(node.x_m(), "nodes.x_m"), finite(node.y_m(), "nodes.y_m")};
  out.clearance_m = finite(node.clearance_m(), "nodes.clearance_m");
  out.base_groups = node.base_groups();
  out.in_main_graph = node.in_main_graph();
  return out;
}

msg::LocalBranch to_branch(const topomap::LocalBranch& branch) {
  msg::LocalBranch out;
  out.id(branch.id);
  out.node_a(branch.node_a);
  out.node_b(branch.node_b);
  out.base_group_a(branch.base_groups[0]);
  out.base_group_b(branch.base_groups[1]);
  out.is_virtual(branch.is_virtual);
  out.in_main_graph(branch.in_main_graph);
  out.confirmed(branch.confirmed);
  out.points(detail::to_branch_points(branch.points, "branches.points"));
  return out;
}

topomap::LocalBranch from_branch(const msg::LocalBranch& branch, std::size_t index,
                                 std::size_t nodes) {
  check(branch.id() == index, "branches.id", "the index in branches");
  check(branch.node_a() < nodes, "branches.node_a", "an index in nodes");
  check(branch.node_b() < nodes, "branches.node_b", "an index in nodes");
  topomap::LocalBranch out;
  out.id = branch.id();
  out.node_a = branch.node_a();
  out.node_b = branch.node_b();
  out.base_groups = {branch.base_group_a(), branch.base_group_b()};
  out.is_virtual = branch.is_virtual();
  out.in_main_graph = branch.in_main_graph();
  out.confirmed = branch.confirmed();
  out.points = detail::from_branch_points(branch.points(), "branches.points");
  return out;
}

msg::ScanPoint to_scan_point(const topomap::ScanPoint& point) {
  msg::ScanPoint out;
  out.x_m(point.x_m);
  out.y_m(point.y_m);
  return out;
}

topomap::ScanPoint from_point(const msg::ScanPoint& point) {
  static_cast<void>(finite(static_cast<double>(point.x_m()), "points.x_m"));
  static_cast<void>(finite(static_cast<double>(point.y_m()), "points.y_m"));
  return {point.x_m(), point.y_m()};
}

msg::TrackedScan to_tracked(const topomap::TrackedScan& scan) {
  msg::TrackedScan out;
  out.sequence_number(scan.sequence);
  out.stamp_ns(scan.stamp_ns);
  out.T_odom_robot(to_msg(scan.T_odom_robot));
  out.T_stop_robot(to_msg(scan.T_stop_robot));
  out.matched(scan.matched);
  return out;
}

topomap::TrackedScan from_tracked(const msg::TrackedScan& scan) {
  return {scan.sequence_number(), scan.stamp_ns(), from_msg(scan.T_odom_robot()),
          from_msg(scan.T_stop_robot()), scan.matched()};
}

}  // namespace

msg::StopId to_msg(const topomap::StopId& stop) {
  msg::StopId out;
  out.session(stop.session);
  out.number(stop.number);
  return out;
}

topomap::StopId from_msg(const msg::StopId& stop) {
  return {stop.session(), stop.number()};
}

msg::LocalMap to_msg(const topomap::LocalMap& map) {
  check_bound("nodes", map.nodes.size(), msg::kMaxLocalNodes);
  check_bound("branches", map.branches.size(), msg::kMaxLocalBranches);
  check_bound("points", map.points.size(), msg::kMaxScanPoints);
  check_bound("track", map.track.size(), msg::kMaxTrackedScans);
  msg::LocalMap out;
  messaging::set_header(out, map.robot_id, map.stamp_ns, map.sequence);
  out.session(map.stop.session);
  out.id(map.id);
  out.odometry_epoch(map.odometry_epoch);
  out.content_hash(topomap::content_hash(map));
  out.T_odom_robot(to_msg(map.T_odom_robot));
  out.T_previous_robot(to_msg(map.T_previous_robot));
  out.T_robot_laser(to_msg(map.T_robot_laser));
  for (const auto& node : map.nodes) out.nodes().push_back(to_node(node));
  for (const auto& branch : map.branches) out.branches().push_back(to_branch(branch));
  for (const auto& point : map.points) out.points().push_back(to_scan_point(point));
  for (const auto& scan : map.track) out.track().push_back(to_tracked(scan));
  return out;
}

topomap::LocalMap content_from_msg(const msg::LocalMap& message) {
  topomap::LocalMap out;
  out.robot_id = message.robot_id().to_string();
  out.id = message.id();
  out.stop = {message.session(), message.id()};
  out.odometry_epoch = message.odometry_epoch();
  out.sequence = message.sequence_number();
  out.stamp_ns = message.stamp_ns();
  out.T_odom_robot = from_msg(message.T_odom_robot());
  out.T_previous_robot = from_msg(message.T_previous_robot());
  out.T_robot_laser = from_msg(message.T_robot_laser());
  for (const auto& node : message.nodes()) out.nodes.push_back(from_node(node, out.nodes.size()));
  for (const auto& branch : message.branches()) {
    out.branches.push_back(from_branch(branch, out.branches.size(), out.nodes.size()));
  }
  for (const auto& point : message.points()) out.points.push_back(from_point(point));
  for (const auto& scan : message.track()) out.track.push_back(from_tracked(scan));
  return out;
}

topomap::LocalMap from_msg(const msg::LocalMap& message) {
  topomap::LocalMap out = content_from_msg(message);
  check(topomap::content_hash(out) == message.content_hash(), "content_hash",
        "the hash of the content");
  return out;
}

msg::TrackedPose to_msg(const topomap::TrackedScan& scan, const topomap::StopId& stop,
                        std::string_view robot_id) {
  msg::TrackedPose out;
  messaging::set_header(out, robot_id, scan.stamp_ns, scan.sequence);
  out.stop(to_msg(stop));
  out.scan(to_tracked(scan));
  return out;
}

topomap::TrackedScan from_msg(const msg::TrackedPose& message) {
  return from_tracked(message.scan());
}

}  // namespace topogeo::service
