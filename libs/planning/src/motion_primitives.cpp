#include "topogeo/planning/motion_primitives.hpp"

#include <cmath>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/check_range.hpp"

#include "straighten.hpp"

namespace topogeo::planning {
namespace {

double angle_of(const Eigen::Vector2d& direction) {
  return geometry::atan2(direction.y(), direction.x());
}

void turn(std::vector<MotionPrimitive>& primitives, double angle_rad, double least_rad) {
  if (std::fabs(angle_rad) <= least_rad) return;
  primitives.push_back(
      {angle_rad > 0.0 ? MotionKind::kTurnLeft : MotionKind::kTurnRight, std::fabs(angle_rad)});
}

}  // namespace

std::vector<Cell> corners_of(std::span<const Cell> cells) {
  std::vector<Cell> corners;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0 && i + 1 < cells.size() &&
        cells[i + 1].column - cells[i].column == cells[i].column - cells[i - 1].column &&
        cells[i + 1].row - cells[i].row == cells[i].row - cells[i - 1].row) {
      continue;
    }
    corners.push_back(cells[i]);
  }
  return corners;
}

bool in_sight(const FreeSpace& space, const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  const GridFrame& frame = space.frame();
  if (!frame.cell_of(a_m) || !frame.cell_of(b_m)) return false;
  return visit_line(frame.in_cells(a_m), frame.in_cells(b_m),
                    [&](const Cell& cell) { return space.passable(cell); });
}

std::vector<Eigen::Vector2d> straighten(const FreeSpace& space, std::span<const Cell> cells,
                                        const Eigen::Vector2d& from_m,
                                        const Eigen::Vector2d& to_m) {
  return straighten_by_rules(
      space, [&](const Cell& cell) { return space.passable(cell); }, cells, from_m, to_m);
}

double length_m(std::span<const Eigen::Vector2d> points_m) {
  double sum_m = 0.0;
  for (std::size_t i = 1; i < points_m.size(); ++i) sum_m += (points_m[i] - points_m[i - 1]).norm();
  return sum_m;
}

std::vector<MotionPrimitive> motion_primitives(std::span<const Eigen::Vector2d> points_m,
                                               double heading_rad,
                                               std::optional<double> final_heading_rad,
                                               const PrimitiveConfig& config) {
  constexpr double kMost_rad = 1e5;  // larger angles are not exact enough
  using support::check_range;
  check_range("motion primitives: min_turn_rad", config.min_turn_rad, 0.0, 1.0);
  check_range("motion primitives: min_advance_m", config.min_advance_m, 0.0, 1.0);
  check_range("motion primitives: heading_rad", heading_rad, -kMost_rad, kMost_rad);
  check_range("motion primitives: final_heading_rad", final_heading_rad.value_or(0.0), -kMost_rad,
              kMost_rad);
  std::vector<MotionPrimitive> primitives;
  double heading = heading_rad;
  for (std::size_t i = 0, at = 0; i < points_m.size(); ++i) {
    if (!points_m[i].allFinite()) {
      throw std::invalid_argument("motion primitives: a point is not finite");
    }
    const Eigen::Vector2d step_m = points_m[i] - points_m[at];
    if (step_m.norm() <= config.min_advance_m) continue;
    const double turn_rad = geometry::wrap_angle(angle_of(step_m) - heading);
    turn(primitives, turn_rad, config.min_turn_rad);
    if (std::fabs(turn_rad) > config.min_turn_rad) heading += turn_rad;
    if (!primitives.empty() && primitives.back().kind == MotionKind::kAdvance) {
      primitives.back().amount += step_m.norm();
    } else {
      primitives.push_back({MotionKind::kAdvance, step_m.norm()});
    }
    at = i;
  }
  if (final_heading_rad) {
    turn(primitives, geometry::wrap_angle(*final_heading_rad - heading), config.min_turn_rad);
  }
  return primitives;
}

geometry::Pose2 pose_after(const geometry::Pose2& T_map_robot,
                           std::span<const MotionPrimitive> primitives) {
  geometry::Pose2 pose = T_map_robot;
  for (const MotionPrimitive& primitive : primitives) {
    switch (primitive.kind) {
      case MotionKind::kAdvance:
        pose = pose * geometry::Pose2{primitive.amount, 0.0, 0.0};
        break;
      case MotionKind::kTurnLeft:
        pose = pose * geometry::Pose2{0.0, 0.0, primitive.amount};
        break;
      case MotionKind::kTurnRight:
        pose = pose * geometry::Pose2{0.0, 0.0, -primitive.amount};
        break;
    }
  }
  return pose;
}

}  // namespace topogeo::planning
