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
    if (edges_.size() < kMostEdges) {
      edges_.push_back({parent, child, T_parent_child, is_static, false, 1});
    }
    return;
  }
  ++known->count;
  if (!is_static && !known->moves) {
    known->moves = !is_same_mounting(known->T_parent_child, T_parent_child);
  }
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

void FrameTree::add(const FrameTree& other) {
  if (edges_.empty()) {
    edges_ = other.edges_;
    return;
  }
  for (const Edge& edge : other.edges_) {
    add(edge.parent, edge.child, edge.T_parent_child, edge.is_static);
    const auto known = std::ranges::find_if(edges_, [&](const Edge& own) {
      return own.child == edge.child && own.parent == edge.parent;
    });
    if (known == edges_.end()) continue;
    known->moves |= edge.moves;
    known->count += edge.count - 1;
  }
}

std::optional<Eigen::Isometry3d> FrameTree::find(const std::string& from,
                                                 const std::string& to) const {
  const std::optional<Eigen::Isometry3d> fixed = find(from, to, Edges::kStatic);
  return fixed ? fixed : find(from, to, Edges::kConstant);
}

std::optional<Eigen::Isometry3d> FrameTree::find(const std::string& from, const std::string& to,
                                                 Edges use) const {
  // Indexed by frame, so that the search is linear in the edges: it runs for each scan, and a peer
  // may have filled the whole tree.
  std::unordered_map<std::string_view, std::vector<const Edge*>> edges_of;
  for (const Edge& edge : edges_) {
    if (use == Edges::kStatic && !edge.is_static) continue;
    if (use == Edges::kConstant && edge.moves) continue;
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

bool is_same_mounting(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  constexpr double kSame_m = 0.05;
  constexpr double kSame_rad = 0.05;
  const Eigen::Isometry3d step = a.inverse() * b;
  const double tilt_rad = std::acos(std::clamp(step.linear()(2, 2), -1.0, 1.0));
  const double turn_rad = std::atan2(step.linear()(1, 0), step.linear()(0, 0));
  return (b.translation() - a.translation()).head<2>().norm() <= kSame_m &&
         std::fabs(turn_rad) <= kSame_rad && tilt_rad <= kLargestTilt_rad;
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
