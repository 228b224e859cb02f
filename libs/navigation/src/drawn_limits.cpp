#include "topogeo/navigation/drawn_limits.hpp"

#include <algorithm>
#include <tuple>

#include "topogeo/planning/driving_rules.hpp"

namespace topogeo::navigation {
namespace {

bool row_by_row(const planning::Cell& a, const planning::Cell& b) {
  return std::tie(a.row, a.column) < std::tie(b.row, b.column);
}

bool contains(const std::vector<planning::Cell>& cells, const planning::Cell& cell) {
  return std::ranges::binary_search(cells, cell, row_by_row);
}

}  // namespace

DrawnLimits::DrawnLimits(const planning::FreeSpace& space) : frame_(space.frame()) {
  const planning::DrivingRules& rules = space.rules();
  for (const planning::Cell& cell : rules.walls()) walls_m_.push_back(frame_.center_m(cell));
  for (const planning::DrawnZone& drawn : rules.zones()) {
    if (drawn.kind != planning::ZoneKind::kNoGo) continue;
    Zone zone;
    zone.cells = planning::DrivingRules(frame_, {&drawn, 1}).no_go();
    std::ranges::sort(zone.cells, row_by_row);
    for (const auto& [column, row] : zone.cells) {
      const bool within =
          contains(zone.cells, {column + 1, row}) && contains(zone.cells, {column - 1, row}) &&
          contains(zone.cells, {column, row + 1}) && contains(zone.cells, {column, row - 1});
      if (!within) zone.rim_m.push_back(frame_.center_m({column, row}));
    }
    if (!zone.rim_m.empty()) zones_.push_back(std::move(zone));
  }
}

std::vector<Eigen::Vector2d> DrawnLimits::near_m(const geometry::Pose2& T_map_robot) const {
  std::vector<Eigen::Vector2d> near_m;
  const geometry::Pose2 T_robot_map = inverse(T_map_robot);
  const auto add = [&](const std::vector<Eigen::Vector2d>& points_m) {
    for (const Eigen::Vector2d& point_m : points_m) {
      if ((point_m - T_map_robot.position_m()).norm() < kReach_m) {
        near_m.push_back(T_robot_map * point_m);
      }
    }
  };
  add(walls_m_);
  const auto cell = empty() ? std::nullopt : frame_.cell_of(T_map_robot.position_m());
  for (const Zone& zone : zones_) {
    if (!cell || !contains(zone.cells, *cell)) add(zone.rim_m);
  }
  return near_m;
}

}  // namespace topogeo::navigation
