#include "topogeo/topomap/visible_rectangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::topomap {

using geometry::Pose2;

namespace {

void include(VisibleRectangle& view, const Eigen::Vector2d& point_m) {
  view.low_m = view.low_m.cwiseMin(point_m);
  view.high_m = view.high_m.cwiseMax(point_m);
}

}  // namespace

VisibleRectangle visible_rectangle(const LocalMap& map, bool with_points) {
  VisibleRectangle view;  // starts with the robot at the origin
  for (const LocalNode& node : map.nodes) {
    if (node.kind != NodeKind::kVirtual) include(view, node.position_m);
  }
  for (const LocalBranch& branch : map.branches) {
    if (branch.is_virtual) continue;
    for (const BranchPoint& point : branch.points) include(view, point.position_m);
  }
  if (!with_points) return view;
  for (const ScanPoint& point : map.points) {
    include(view, {static_cast<double>(point.x_m), static_cast<double>(point.y_m)});
  }
  return view;
}

bool contains(const VisibleRectangle& view, const Eigen::Vector2d& point_m) {
  return (view.low_m.array() <= point_m.array()).all() &&
         (point_m.array() <= view.high_m.array()).all();
}

VisibleRectangle seen_from(const VisibleRectangle& view, const Pose2& T_frame_robot,
                           const Eigen::Vector3d& half_width) {
  if (!half_width.allFinite() || half_width.minCoeff() < 0.0) {
    throw std::invalid_argument("seen_from: half-widths must be finite and not negative");
  }
  const double turn_rad = std::min(half_width.z(), std::numbers::pi);
  const std::array<Eigen::Vector2d, 4> corners{view.low_m,
                                               {view.low_m.x(), view.high_m.y()},
                                               view.high_m,
                                               {view.high_m.x(), view.low_m.y()}};
  static const std::array<Eigen::Vector2d, 4> kAxes{
      Eigen::Vector2d{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
  const Pose2 turned_right{0.0, 0.0, T_frame_robot.theta_rad - turn_rad};
  const Pose2 turned_left{0.0, 0.0, T_frame_robot.theta_rad + turn_rad};
  VisibleRectangle seen;
  seen.low_m = seen.high_m = turned_right * corners[0];
  for (const Eigen::Vector2d& corner : corners) {
    include(seen, turned_right * corner);
    include(seen, turned_left * corner);
    const double direction_rad = T_frame_robot.theta_rad + geometry::atan2(corner.y(), corner.x());
    for (std::size_t k = 0; k < kAxes.size(); ++k) {
      const double axis_rad = 0.5 * std::numbers::pi * static_cast<double>(k);
      // The arc of the corner crosses the axis, where it is farthest out.
      if (std::fabs(geometry::wrap_angle(axis_rad - direction_rad)) <= turn_rad) {
        include(seen, corner.norm() * kAxes[k]);
      }
    }
  }
  const Eigen::Vector2d shift = half_width.head<2>();
  seen.low_m += T_frame_robot.position_m() - shift;
  seen.high_m += T_frame_robot.position_m() + shift;
  return seen;
}

bool overlap(const VisibleRectangle& a, const VisibleRectangle& b) {
  return (a.low_m.array() <= b.high_m.array()).all() && (b.low_m.array() <= a.high_m.array()).all();
}

std::vector<std::uint32_t> overlap_set(const VisibleRectangle& view,
                                       std::span<const VisibleRectangle> earlier,
                                       std::span<const PlacedView> places) {
  if (earlier.size() != places.size()) {
    throw std::invalid_argument("overlap_set: expected one place for each earlier map");
  }
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < earlier.size(); ++i) {
    if (overlap(seen_from(view, places[i].T_earlier_new, places[i].half_width), earlier[i])) {
      found.push_back(i);
    }
  }
  return found;
}

std::vector<std::uint32_t> newly_seen(std::span<const std::uint32_t> overlaps,
                                      std::span<const std::uint32_t> overlaps_before,
                                      std::uint32_t before) {
  std::vector<std::uint32_t> fresh;
  std::set_difference(overlaps.begin(), overlaps.end(), overlaps_before.begin(),
                      overlaps_before.end(), std::back_inserter(fresh));
  std::erase(fresh, before);
  return fresh;
}

}  // namespace topogeo::topomap
