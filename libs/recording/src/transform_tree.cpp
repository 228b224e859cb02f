#include "topogeo/recording/transform_tree.hpp"

#include <algorithm>
#include <deque>
#include <set>
#include <utility>

#include "topogeo/recording/laser_scan.hpp"

namespace topogeo::recording {
namespace {

/// Frames that any recording has; more are the work of a damaged or hostile one.
constexpr std::size_t kMostEdges = 4096;

}  // namespace

void TransformTree::add(const ros::TfMessage& message, bool is_static) {
  for (const ros::TransformStamped& stated : message.transforms_()) {
    Edge edge{frame_name(stated.header_().frame_id_()), frame_name(stated.child_frame_id_()),
              to_isometry(stated.transform_()), is_static, 1};
    if (!edge.T_parent_child.matrix().allFinite() || edge.parent == edge.child) continue;
    const auto known = std::ranges::find_if(edges_, [&](const Edge& other) {
      return other.child == edge.child && other.parent == edge.parent;
    });
    if (known == edges_.end()) {
      if (edges_.size() < kMostEdges) edges_.push_back(std::move(edge));
      continue;
    }
    ++known->count;
    if (is_static) {
      known->T_parent_child = edge.T_parent_child;
      known->is_static = true;
    }
  }
}

std::optional<Eigen::Isometry3d> TransformTree::find(const std::string& from,
                                                     const std::string& to) const {
  const std::optional<Eigen::Isometry3d> fixed = find(from, to, true);
  return fixed ? fixed : find(from, to, false);
}

std::optional<Eigen::Isometry3d> TransformTree::find(const std::string& from, const std::string& to,
                                                     bool static_only) const {
  std::deque<std::pair<std::string, Eigen::Isometry3d>> reached = {
      {from, Eigen::Isometry3d::Identity()}};
  std::set<std::string> seen = {from};
  while (!reached.empty()) {
    const auto [frame, T_from_frame] = reached.front();
    reached.pop_front();
    if (frame == to) return T_from_frame;
    for (const Edge& edge : edges_) {
      if (static_only && !edge.is_static) continue;
      if (edge.parent == frame && seen.insert(edge.child).second) {
        reached.emplace_back(edge.child, T_from_frame * edge.T_parent_child);
      } else if (edge.child == frame && seen.insert(edge.parent).second) {
        reached.emplace_back(edge.parent, T_from_frame * edge.T_parent_child.inverse());
      }
    }
  }
  return std::nullopt;
}

}  // namespace topogeo::recording
