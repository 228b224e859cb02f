#include "frame_tree.hpp"

#include <cmath>
#include <utility>

#include "geometry.hpp"

namespace topogeo::ros_bridge {
namespace {

/// Deeper chains are circles.
constexpr int kDeepest = 100;
constexpr double kCosineOfLargestTilt = 0.99;

}  // namespace

bool FrameTree::put(const std::string& parent, const std::string& child,
                    const Eigen::Isometry3d& T_parent_child) {
  const auto [link, added] = links_.try_emplace(child);
  if (!added && link->second.parent != parent) return false;
  link->second = {parent, T_parent_child};
  return true;
}

std::pair<std::string, Eigen::Isometry3d> FrameTree::to_top(const std::string& frame) const {
  std::pair<std::string, Eigen::Isometry3d> top{frame, Eigen::Isometry3d::Identity()};
  for (int depth = 0; depth < kDeepest; ++depth) {
    const auto link = links_.find(top.first);
    if (link == links_.end()) break;
    top = {link->second.parent, link->second.T_parent_child * top.second};
  }
  return top;
}

std::optional<Eigen::Isometry3d> FrameTree::find(const std::string& target,
                                                 const std::string& source) const {
  const auto [target_top, T_top_target] = to_top(target);
  const auto [source_top, T_top_source] = to_top(source);
  if (target_top != source_top) return std::nullopt;
  return Eigen::Isometry3d(T_top_target.inverse() * T_top_source);
}

std::optional<Mounting> mounting_of(const Eigen::Isometry3d& T_robot_laser) {
  const double up = T_robot_laser.linear()(2, 2);
  if (std::fabs(up) < kCosineOfLargestTilt) return std::nullopt;
  return Mounting{planar(T_robot_laser), up < 0.0};
}

}  // namespace topogeo::ros_bridge
