#include "floor_plan.hpp"

#include <algorithm>

namespace topogeo::simulation {
namespace {

constexpr double kWall_m = 0.12;      // between corridor and room
constexpr double kDoor_m = 0.9;       // like a wide office door
constexpr double kNarrowest_m = 3.0;  // room

Eigen::Vector2d along(const Side& side) {
  return (side.to_m - side.from_m) / (side.to_m - side.from_m).norm();
}

}  // namespace

void FloorPlan::line(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) const {
  world_.segments.push_back({a_m, b_m});
}

void FloorPlan::box(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m,
                    const Eigen::Vector2d& out, double depth_m) const {
  const Eigen::Vector2d far = out * depth_m;
  line(a_m, a_m + far);
  line(a_m + far, b_m + far);
  line(b_m + far, b_m);
}

std::vector<FloorPlan::Piece> FloorPlan::divide(double length_m, double open_share,
                                                support::Random& random) {
  std::vector<Piece> pieces;
  double at_m = 0.0;
  while (at_m < length_m) {
    double width_m = random.uniform(kNarrowest_m, 6.0);
    if (length_m - at_m - width_m < kNarrowest_m) width_m = length_m - at_m;
    const double door_m = random.uniform(at_m + 0.9, at_m + width_m - 0.9);
    pieces.push_back({at_m, at_m + width_m, door_m, random.uniform() < open_share});
    at_m += width_m;
  }
  return pieces;
}

void FloorPlan::wall(const Side& side, const std::vector<Piece>& pieces) const {
  constexpr double kSetBack_m = 0.08;  // of a shut door
  const Eigen::Vector2d u = along(side);
  Eigen::Vector2d begin_m = side.from_m;
  for (const Piece& piece : pieces) {
    const Eigen::Vector2d near_m = side.from_m + u * (piece.door_m - kDoor_m / 2.0);
    const Eigen::Vector2d far_m = near_m + u * kDoor_m;
    line(begin_m, near_m);
    begin_m = far_m;
    if (piece.open) {
      line(near_m, near_m + side.out * kWall_m);
      line(far_m, far_m + side.out * kWall_m);
    } else {
      box(near_m, far_m, side.out, kSetBack_m);
    }
  }
  line(begin_m, side.to_m);
}

void FloorPlan::clutter(const Side& side, const std::vector<Piece>& pieces,
                        support::Random& random) const {
  constexpr double kShare = 0.35;  // of the rooms, with a cupboard or a pillar in front
  const Eigen::Vector2d u = along(side);
  for (const Piece& piece : pieces) {
    const double draw = random.uniform();
    const double length_m = random.uniform(0.4, 1.4);
    const double depth_m = random.uniform(0.15, 0.45);
    const double left_m = piece.door_m - piece.from_m;
    const double right_m = piece.to_m - piece.door_m;
    const double room_m = std::max(left_m, right_m) - kDoor_m;
    if (draw >= kShare || room_m < length_m) continue;
    const double from_m = left_m > right_m ? piece.from_m + 0.1 : piece.to_m - 0.1 - length_m;
    const Eigen::Vector2d a_m = side.from_m + u * from_m;
    box(a_m, a_m + u * length_m, -side.out, depth_m);
  }
}

void FloorPlan::furniture(const Side& side, const Piece& piece, double depth_m,
                          support::Random& random) const {
  const Eigen::Vector2d u = along(side);
  const Eigen::Vector2d corner_m = side.from_m + u * piece.from_m;
  const double width_m = piece.to_m - piece.from_m;
  // Along the back wall.
  const double back_m = random.uniform(0.8, width_m - 1.0);
  const double start_m = random.uniform(0.1, width_m - back_m - 0.1);
  const Eigen::Vector2d a_m = corner_m + u * start_m + side.out * depth_m;
  box(a_m, a_m + u * back_m, -side.out, random.uniform(0.4, 0.9));
  // Along the side walls.
  for (const bool left : {true, false}) {
    const double draw = random.uniform();
    const double long_m = random.uniform(0.5, 1.5);
    const double deep_m = random.uniform(0.3, 0.8);
    const double from_m = random.uniform(1.0, 1.4);
    if (draw >= 0.5) continue;
    const Eigen::Vector2d b_m = corner_m + (left ? 0.0 : width_m) * u + side.out * from_m;
    box(b_m, b_m + side.out * long_m, left ? u : Eigen::Vector2d(-u), deep_m);
  }
}

void FloorPlan::rooms(const Side& side, double depth_m, support::Random& random) const {
  constexpr double kOpenShare = 0.6;
  const double length_m = (side.to_m - side.from_m).norm();
  if (length_m < kNarrowest_m) return line(side.from_m, side.to_m);
  const std::vector<Piece> pieces = divide(length_m, kOpenShare, random);
  wall(side, pieces);
  clutter(side, pieces, random);
  const Eigen::Vector2d u = along(side);
  for (const Piece& piece : pieces) {
    furniture(side, piece, depth_m, random);
    if (!piece.open) continue;  // never visible
    const Eigen::Vector2d a_m = side.from_m + u * piece.from_m + side.out * kWall_m;
    const Eigen::Vector2d b_m = side.from_m + u * piece.to_m + side.out * kWall_m;
    line(a_m, b_m - u * (piece.to_m - piece.door_m + kDoor_m / 2.0));
    line(a_m + u * (piece.door_m - piece.from_m + kDoor_m / 2.0), b_m);
    box(a_m, b_m, side.out, depth_m - kWall_m);
  }
}

void FloorPlan::shut_doors(const Side& side, support::Random& random) const {
  const double length_m = (side.to_m - side.from_m).norm();
  if (length_m < kNarrowest_m) return line(side.from_m, side.to_m);
  const std::vector<Piece> pieces = divide(length_m, 0.0, random);
  wall(side, pieces);
  clutter(side, pieces, random);
}

void FloorPlan::furnish(const Eigen::Vector2d& low_m, const Eigen::Vector2d& high_m,
                        support::Random& random) const {
  const double width_m = high_m.x() - low_m.x();
  for (const bool top : {true, false}) {
    const double y_m = top ? high_m.y() : low_m.y();
    const Eigen::Vector2d inwards(0.0, top ? -1.0 : 1.0);
    double at_m = random.uniform(0.1, 0.8);
    while (true) {
      const double long_m = random.uniform(0.5, 1.6);
      const double deep_m = random.uniform(0.3, 0.7);
      if (at_m + long_m > width_m - 0.1) break;
      const Eigen::Vector2d a_m(low_m.x() + at_m, y_m);
      box(a_m, a_m + Eigen::Vector2d(long_m, 0.0), inwards, deep_m);
      at_m += long_m + random.uniform(0.4, 1.6);
    }
  }
  // A column beside the middle line, where the tour runs.
  const double share = random.uniform(0.3, 0.7);
  const double radius_m = random.uniform(0.15, 0.3);
  const double y_m = low_m.y() + (high_m.y() - low_m.y()) * (random.uniform() < 0.5 ? 0.25 : 0.75);
  world_.circles.push_back({{low_m.x() + share * width_m, y_m}, radius_m});
}

}  // namespace topogeo::simulation
