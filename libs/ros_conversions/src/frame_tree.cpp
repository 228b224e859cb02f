#include "topogeo/ros_conversions/frame_tree.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "topogeo/ros_conversions/geometry.hpp"

namespace topogeo::ros {
namespace {

/// More frames than any robot has come from a damaged recording or a hostile peer.
constexpr std::size_t kMostEdges = 4096;

double rounded_to(double value, double steps_per_unit) {
  return std::round(value * steps_per_unit) / steps_per_unit + 0.0;  // no -0
}

bool short_enough(const std::string& parent, const std::string& child) {
  return parent.size() <= kLongestFrameName && child.size() <= kLongestFrameName;
}

}  // namespace

void FrameTree::add(const std::string& parent, const std::string& child,
                    const Eigen::Isometry3d& T_parent_child, bool is_static) {
  if (parent == child || !short_enough(parent, child)) return;
  const auto known = std::ranges::find_if(
      edges_, [&](const Edge& other) { return other.child == child && other.parent == parent; });
  if (known == edges_.end()) {
    if (edges_.size() < kMostEdges) edges_.push_back({parent, child, T_parent_child, is_static, 1});
    return;
  }
  ++known->count;
  if (is_static) {
    known->T_parent_child = T_parent_child;
    known->is_static = true;
  }
}

void FrameTree::add(const TFMessage& message, bool is_static) {
  for (const TransformStamped& stated : message.transforms_()) {
    const auto T_parent_child = isometry_of(stated.transform_());
    if (!T_parent_child) continue;
    add(frame_name(stated.header_().frame_id_()), frame_name(stated.child_frame_id_()),
        *T_parent_child, is_static);
  }
}

bool FrameTree::put(const std::string& parent, const std::string& child,
                    const Eigen::Isometry3d& T_parent_child) {
  if (!short_enough(parent, child)) return false;
  const auto known = std::ranges::find(edges_, child, &Edge::child);
  if (known != edges_.end() && known->parent != parent) return false;
  add(parent, child, T_parent_child, true);
  return true;
}

std::optional<Eigen::Isometry3d> FrameTree::find(const std::string& from,
                                                 const std::string& to) const {
  const std::optional<Eigen::Isometry3d> fixed = find(from, to, true);
  return fixed ? fixed : find(from, to, false);
}

std::optional<Eigen::Isometry3d> FrameTree::find(const std::string& from, const std::string& to,
                                                 bool static_only) const {
  // Indexed by frame, so that the search is linear in the edges: it runs for each scan, and a peer
  // may have filled the whole tree.
  std::unordered_map<std::string_view, std::vector<const Edge*>> edges_of;
  for (const Edge& edge : edges_) {
    if (static_only && !edge.is_static) continue;
    edges_of[edge.parent].push_back(&edge);
    edges_of[edge.child].push_back(&edge);
  }
  std::deque<std::pair<std::string_view, Eigen::Isometry3d>> reached = {
      {from, Eigen::Isometry3d::Identity()}};
  std::unordered_set<std::string_view> seen = {from};
  while (!reached.empty()) {
    const auto [frame, T_from_frame] = reached.front();
    reached.pop_front();
    if (frame == to) return T_from_frame;
    for (const Edge* edge : edges_of[frame]) {
      if (edge->parent == frame && seen.insert(edge->child).second) {
        reached.emplace_back(edge->child, T_from_frame * edge->T_parent_child);
      } else if (edge->child == frame && seen.insert(edge->parent).second) {
        reached.emplace_back(edge->parent, T_from_frame * edge->T_parent_child.inverse());
      }
    }
  }
  return std::nullopt;
}

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

}  // namespace topogeo::ros
