// Local maps of a hand-drawn floor: walls for the scan, and the branches of a perfect diagram, of
// which each view gets the visible parts.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::topomap::test {

struct Wall {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
};

struct FloorBranch {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  double clearance_m = 1.0;
};

struct FloorNode {
  Eigen::Vector2d position_m;
  double clearance_m = 1.0;
  NodeKind kind = NodeKind::kReal;
};

struct Floor {
  std::vector<Wall> walls;
  std::vector<FloorBranch> branches;
  std::vector<FloorNode> nodes;
};

/// Two walls 2 m apart along x, the axis between them.
Floor corridor(double length_m);

///        |   |
///        | 1 |
/// -------+   +-------      T junction at (10, 0), arms 2 m wide
///  0             2
/// -------------------
Floor t_junction();

/// A corridor with a room behind a door at x = 6: walls of the door posts from y = 1 to 1.2; the
/// branch goes through the doorway to the middle of the room.
Floor room_behind_door(bool open);

/// Outer wall 24 x 16 m, with a block in it that leaves corridors 2 m wide all round.
Floor loop_of_corridors();

/// View of the floor from a pose, by a laser with 361 beams over 180 degrees and 8 m of range; the
/// local map is drawn as if the robot were at `T_map_robot`.
LocalMap view(const Floor& floor, const geometry::Pose2& T_map_robot);

}  // namespace topogeo::topomap::test
