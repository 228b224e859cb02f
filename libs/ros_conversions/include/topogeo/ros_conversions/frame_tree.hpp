// The frames of a robot as /tf and /tf_static state them (REP 105), without their times: for what
// is fixed, like the mounting of a laser.
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

/// Transforms of frames with longer names are left out: they are kept, as many as a peer likes.
inline constexpr std::size_t kLongestFrameName = 255;

class FrameTree {
 public:
  struct Edge {
    std::string parent;
    std::string child;
    Eigen::Isometry3d T_parent_child = Eigen::Isometry3d::Identity();
    bool is_static = false;
    std::uint64_t count = 0;  ///< how often it was stated
  };

  /// Of a static transform the last one holds, of another the first. A child may have several
  /// parents: recordings have `odom -> base_link` beside `odom -> base_footprint`.
  void add(const std::string& parent, const std::string& child,
           const Eigen::Isometry3d& T_parent_child, bool is_static);
  /// Each of the message; those that are not finite are passed over.
  void add(const TFMessage& message, bool is_static);

  /// As a static one of a live robot, on which a child has one parent: false, and nothing is kept,
  /// where it hangs on another or a name is too long.
  bool put(const std::string& parent, const std::string& child,
           const Eigen::Isometry3d& T_parent_child);

  /// Takes coordinates of `to` into those of `from`, over as few edges as possible, static ones
  /// alone where these suffice; empty where no edges connect the two.
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to) const;

  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }

 private:
  [[nodiscard]] std::optional<Eigen::Isometry3d> find(const std::string& from,
                                                      const std::string& to,
                                                      bool static_only) const;

  std::vector<Edge> edges_;
};

/// Where a laser sits, seen from above.
struct LaserMounting {
  geometry::Pose2 T_robot_laser;  ///< of an upside-down laser: of the frame that is its own turned
                                  ///< about x by pi
  bool upside_down = false;       ///< its beams then go clockwise
  double tilt_rad = 0.0;          ///< between its plane and the floor, in [0, pi / 2]

  friend bool operator==(const LaserMounting&, const LaserMounting&) = default;
};

/// A plane that leans more than this measures other walls than those of the floor plan.
inline constexpr double kLargestTilt_rad = 8.0 * std::numbers::pi / 180.0;

/// Rounded to 0.1 mm and 0.00001 rad like that of a CARMEN log, so that one drive has the same
/// mounting in each format.
LaserMounting planar_mounting(const Eigen::Isometry3d& T_robot_laser);

}  // namespace topogeo::ros
