// Draws rows of rooms, corridors and furniture into a world.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::simulation {

/// One side of a corridor, from `from` to `to`, axis-parallel; the unit vector `out` points away
/// from the corridor.
struct Side {
  Eigen::Vector2d from_m;
  Eigen::Vector2d to_m;
  Eigen::Vector2d out;
};

class FloorPlan {
 public:
  explicit FloorPlan(world::World& world) : world_(world) {}

  void line(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const;
  /// A box with one edge from `a` to `b`, `depth_m` deep along `out`; no line on that edge.
  void box(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m, const Eigen::Vector2d& out,
           double depth_m) const;

  /// Rooms of 3 to 6 m along a side, `depth_m` deep, each with a door and furniture, and occasional
  /// obstacles in the corridor. A side shorter than 3 m is a plain wall.
  void rooms(const Side& side, double depth_m, support::Random& random) const;

  /// A side without rooms behind it: a wall with shut doors, and obstacles in the corridor.
  void shut_doors(const Side& side, support::Random& random) const;

  /// Furniture along the lower and upper wall of a hall, given by two of its corners, and a column;
  /// does not draw the hall's walls. Its middle line stays free.
  void furnish(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m,
               support::Random& random) const;

 private:
  struct Piece {
    double from_m;
    double to_m;
    double door_m;  // middle of the door
    bool open;
  };
  static std::vector<Piece> divide(double length_m, double open_share, support::Random& random);
  void wall(const Side& side, const std::vector<Piece>& pieces) const;
  void clutter(const Side& side, const std::vector<Piece>& pieces, support::Random& random) const;
  void furniture(const Side& side, const Piece& piece, double depth_m,
                 support::Random& random) const;

  world::World& world_;
};

}  // namespace topogeo::simulation
