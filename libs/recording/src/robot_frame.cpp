#include "robot_frame.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

namespace topogeo::recording {
namespace {

using Edge = ros::FrameTree::Edge;

std::set<std::string> frames_of(const ros::FrameTree& tree) {
  std::set<std::string> frames;
  for (const Edge& edge : tree.edges()) {
    frames.insert(edge.parent);
    frames.insert(edge.child);
  }
  return frames;
}

/// The frame of this name, or the only one that differs by its prefix; empty if there is none.
std::string known_frame(const std::set<std::string>& frames, const std::string& name) {
  if (name.empty() || frames.contains(name)) return name;
  std::string found;
  for (const std::string& frame : frames) {
    if (name_without_prefix(frame) != name_without_prefix(name)) continue;
    if (!found.empty()) return {};
    found = frame;
  }
  return found;
}

/// Whether robots move in the frame, by its name.
bool is_fixed_frame(const std::string& frame, const std::string& odom) {
  const std::string name = name_without_prefix(frame);
  return (!odom.empty() && name == name_without_prefix(odom)) || name.starts_with("odom") ||
         name == "map" || name == "world";
}

using Steps = std::multimap<std::string, std::string>;

/// The frames that steps lead to, including the first.
std::set<std::string> reached_from(const std::string& first, const Steps& steps) {
  std::set<std::string> reached = {first};
  std::vector<std::string> next = {first};
  while (!next.empty()) {
    const std::string frame = std::move(next.back());
    next.pop_back();
    const auto [begin, end] = steps.equal_range(frame);
    for (auto step = begin; step != end; ++step) {
      if (reached.insert(step->second).second) next.push_back(step->second);
    }
  }
  return reached;
}

class Search {
 public:
  Search(const ros::FrameTree& tree, const OdometryFrames& stated, const std::string& laser)
      : tree_(tree), stated_(stated), stated_laser_(laser), frames_(frames_of(tree)) {
    laser_ = known_frame(frames_, laser);
    if (laser_.empty()) return;
    Steps up;
    Steps constant;
    for (const Edge& edge : tree.edges()) {
      up.emplace(edge.child, edge.parent);
      if (edge.moves) continue;
      constant.emplace(edge.child, edge.parent);
      constant.emplace(edge.parent, edge.child);
    }
    above_laser_ = reached_from(laser_, up);
    with_laser_ = reached_from(laser_, constant);
    if (!stated.child.empty() && !is_fixed_frame(stated.child, stated.odom)) {
      child_ = known_frame(frames_, stated.child);
    }
  }

  RobotFrame result() const {
    if (!stated_laser_.empty() && stated_.child == stated_laser_) {
      return {stated_laser_, Eigen::Isometry3d::Identity(), false, {}};
    }
    if (laser_.empty()) return unknown();
    if (std::optional<RobotFrame> stated = by_name(child_)) return *std::move(stated);
    if (above_laser_.contains(child_)) return moving(child_);
    if (std::optional<RobotFrame> moved = by_motion()) return *std::move(moved);
    if (const Edge* joint = joint_below_robot()) return moving(joint->parent);
    for (const char* name : {"base_link", "base_footprint", "base"}) {
      if (std::optional<RobotFrame> usual = by_name(known_frame(frames_, name))) return *usual;
    }
    if (std::optional<RobotFrame> root = by_name(root_above_laser())) return *std::move(root);
    return unknown();
  }

 private:
  [[nodiscard]] std::string frames_text(const std::string& robot) const {
    return robot + " -> " + (laser_.empty() ? stated_laser_ : laser_);
  }

  [[nodiscard]] std::optional<RobotFrame> by_name(const std::string& frame) const {
    if (frame.empty() || !with_laser_.contains(frame)) return std::nullopt;
    // Another robot has another prefix.
    if (!child_.empty() && prefix_of(frame) != prefix_of(child_)) return std::nullopt;
    const auto T_robot_laser = tree_.find(frame, laser_);
    if (!T_robot_laser) return std::nullopt;
    RobotFrame found{frame, T_robot_laser, false, {}};
    if (frame != stated_.child || laser_ != stated_laser_) {
      found.note = "the odometry is of \"" + stated_.child + "\" and the scans of \"" +
                   stated_laser_ + "\": the mounting of the laser is that of " + frames_text(frame);
    }
    return found;
  }

  /// The frame that moves under the odometry frame and carries the laser.
  [[nodiscard]] std::optional<RobotFrame> by_motion() const {
    std::vector<const Edge*> edges;
    edges.reserve(tree_.edges().size());
    for (const Edge& edge : tree_.edges()) {
      if (edge.is_static || !is_fixed_frame(edge.parent, stated_.odom)) continue;
      if (is_fixed_frame(edge.child, stated_.odom)) continue;
      edges.push_back(&edge);
    }
    std::ranges::stable_sort(edges, {}, [this](const Edge* edge) {
      return std::pair(edge->parent != stated_.odom,
                       name_without_prefix(edge->child) != "base_link");
    });
    for (const Edge* edge : edges) {
      if (std::optional<RobotFrame> found = by_name(edge->child)) return found;
    }
    return std::nullopt;
  }

  /// A transform that moves between robot and laser; null if there is none.
  [[nodiscard]] const Edge* joint_below_robot() const {
    const auto joint = std::ranges::find_if(tree_.edges(), [this](const Edge& edge) {
      return edge.moves && with_laser_.contains(edge.child) && above_laser_.contains(edge.parent) &&
             !is_fixed_frame(edge.parent, stated_.odom);
    });
    return joint == tree_.edges().end() ? nullptr : &*joint;
  }

  /// Empty if the laser has no parent, or if the root is the frame of odometry or a map.
  [[nodiscard]] std::string root_above_laser() const {
    std::string frame = laser_;
    for (std::size_t steps = 0; steps <= tree_.edges().size(); ++steps) {
      const auto above = std::ranges::find_if(tree_.edges(), [&](const Edge& edge) {
        return edge.child == frame && !edge.moves && !is_fixed_frame(edge.parent, stated_.odom);
      });
      if (above == tree_.edges().end()) break;
      frame = above->parent;
    }
    return frame == laser_ ? std::string() : frame;
  }

  [[nodiscard]] RobotFrame moving(const std::string& robot) const {
    return {stated_.child,
            {},
            true,
            "the laser moves on the robot (" + frames_text(robot) +
                " is not constant): its mounting is unknown"};
  }

  [[nodiscard]] RobotFrame unknown() const {
    std::string note =
        "no transforms " + frames_text(stated_.child) + ": the mounting of the laser is unknown";
    constexpr std::size_t kMost = 10;
    std::size_t listed = 0;
    for (const std::string& frame : frames_) {
      if (listed == kMost) {
        note += ", ...";
        break;
      }
      note += (listed++ == 0 ? " (there are transforms of " : ", ") + frame;
    }
    return {stated_.child, {}, false, note + (listed == 0 ? "" : ")")};
  }

  const ros::FrameTree& tree_;
  const OdometryFrames& stated_;
  const std::string& stated_laser_;
  std::set<std::string> frames_;
  std::string laser_;                  // in the tree
  std::set<std::string> above_laser_;  // frames that carry it, on any joints
  std::set<std::string> with_laser_;   // frames that constant transforms connect to it
  std::string child_;  // in the tree; empty also if it is a frame in which robots move
};

}  // namespace

RobotFrame find_robot_frame(const ros::FrameTree& tree, const OdometryFrames& stated,
                            const std::string& laser) {
  return Search(tree, stated, laser).result();
}

std::string name_without_prefix(const std::string& frame) {
  return frame.substr(frame.rfind('/') + 1);
}

std::string prefix_of(const std::string& frame) {
  const std::size_t end = frame.rfind('/');
  return end == std::string::npos ? std::string() : frame.substr(0, end);
}

}  // namespace topogeo::recording
