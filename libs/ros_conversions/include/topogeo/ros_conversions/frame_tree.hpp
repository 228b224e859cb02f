// The frames of a robot as /tf and /tf_static state them (REP 105), without their times: for fixed
// transforms, like the mounting of a laser. Transforms that move are kept apart.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::ros {

/// Transforms with longer frame names are ignored, because a peer may state any number of them.
inline constexpr std::size_t kLongestFrameName = 255;

class FrameTree {
 public:
  struct Edge {
    std::string parent;
    std::string child;
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    bool is_static = false;
    bool moves = false;       ///< it was stated with another value, see is_same_mounting()
    std::uint64_t count = 0;  ///< number of times it was stated
  };

  /// A static transform replaces the previous one, any other keeps the first. A child may have
  /// several parents: recordings have `odom -> base_link` beside `odom -> base_footprint`.
  void add(const std::string& parent, const std::string& child,
           const Eigen::Isometry3d& T_parent_child, bool is_static);
  /// Adds each transform of the message that is finite.
  void add(const TFMessage& message, bool is_static);

  /// Adds a static transform of a live robot, on which a child has one parent. Returns false and
  /// adds nothing if the child has another parent or a name is too long.
  bool put(const std::string& parent, const std::string& child,
           const Eigen::Isometry3d& T_parent_child);

  /// The transform that takes coordinates of `to` to those of `from`, over as few edges as
  /// possible, preferring static ones only. Empty if no edges connect the two without one that
  /// moves.
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to) const;

  /// Adds the edges of another tree, each as often as it was stated there.
  void add(const FrameTree& other);

  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }

 private:
  enum class Edges : std::uint8_t { kStatic, kConstant };
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to, Edges use) const;

  std::vector<Edge> edges_;
};

/// Pose of a laser on its robot, in plan view.
struct LaserMounting {
  geometry::Pose2 T_robot_laser;  ///< for an upside-down laser: of its frame turned by pi about x
  bool upside_down = false;       ///< its beams then go clockwise
  double tilt_rad = 0.0;          ///< between its plane and the floor, in [0, pi / 2]

  friend bool operator==(const LaserMounting&, const LaserMounting&) = default;
};

/// A plane that leans more than this does not measure the walls of the floor plan.
inline constexpr double kLargestTilt_rad = 8.0 * std::numbers::pi / 180.0;

/// Whether two values of a transform are one mounting: within 5 cm and 0.05 rad in plan view, which
/// is more than a joint that holds its place jitters, and within kLargestTilt_rad of tilt, which a
/// suspension may have.
bool is_same_mounting(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b);

/// The mounting, rounded to 0.1 mm and 0.00001 rad as in a CARMEN log, so that a drive has the same
/// mounting in each format.
LaserMounting planar_mounting(const Eigen::Isometry3d& T_robot_laser);

}  // namespace topogeo::ros
