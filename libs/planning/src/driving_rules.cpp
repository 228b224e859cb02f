#include "topogeo/planning/driving_rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

#include "line_cells.hpp"
#include "polygon_cells.hpp"

namespace topogeo::planning {
namespace {

/// Speed outside of slow zones, the default of follower.speed_m_per_s: only the ratio to it counts.
constexpr double kUsualSpeed_m_s = 0.6;
/// Lower limits count as this one, because a detour is never a hundred times longer.
constexpr double kLeastSpeed_m_s = 0.006;

/// Factor by which a step beside the preferred lanes costs more: a lane is taken if the route along
/// it is at most so many times as long. The lanes do not cost less instead, because the estimate of
/// the search must stay a lower bound.
constexpr float kBesideLanes = 1.5F;

constexpr double kCosOf120Degrees = -0.5;

/// Same order as CellGraph.
const std::array<Eigen::Vector2d, 8>& grid_directions() {
  static const std::array<Eigen::Vector2d, 8> kDirections = {Eigen::Vector2d(1, 0),
                                                             Eigen::Vector2d(0, 1),
                                                             Eigen::Vector2d(-1, 0),
                                                             Eigen::Vector2d(0, -1),
                                                             Eigen::Vector2d(1, 1).normalized(),
                                                             Eigen::Vector2d(-1, 1).normalized(),
                                                             Eigen::Vector2d(-1, -1).normalized(),
                                                             Eigen::Vector2d(1, -1).normalized()};
  return kDirections;
}

bool along(const Eigen::Vector2d& heading, const Eigen::Vector2d& direction) {
  constexpr double kRounding = 1e-9;  // exactly 120 degrees are allowed
  return direction.dot(heading) >= kCosOf120Degrees * direction.norm() - kRounding;
}

}  // namespace

bool may_drive(const DrawnZone& one_way, const Eigen::Vector2d& direction_m) {
  const auto [sin, cos] = geometry::sincos(one_way.value);
  return along({cos, sin}, direction_m);
}

DrivingRules::DrivingRules(const GridFrame& frame, std::span<const DrawnZone> zones,
                           std::span<const DrawnLine> lines)
    : lines_(lines.begin(), lines.end()) {
  LineCells cells = cells_of_lines(frame, lines_);
  walls_ = std::move(cells.walls);
  open_ = std::move(cells.open);
  no_go_ = walls_;
  for (const DrawnZone& zone : zones) {
    if (zone.kind != ZoneKind::kRoom && zone.polygon_m.size() >= 3) zones_.push_back(zone);
  }
  std::map<std::size_t, std::vector<std::size_t>> zones_of_cell;  // all kinds but no-go
  for (std::size_t i = 0; i < zones_.size(); ++i) {
    visit_cells_in(frame, zones_[i].polygon_m, [&](const Cell& cell) {
      if (zones_[i].kind == ZoneKind::kNoGo) {
        no_go_.push_back(cell);
      } else {
        zones_of_cell[frame.index(cell)].push_back(i);
      }
    });
  }
  if (zones_of_cell.empty()) return;
  area_.assign(frame.size(), 0);
  areas_.emplace_back();
  std::map<std::vector<std::size_t>, std::uint32_t> numbers;
  for (const auto& [cell, of_cell] : zones_of_cell) {
    const auto [entry, is_new] =
        numbers.try_emplace(of_cell, static_cast<std::uint32_t>(areas_.size()));
    area_[cell] = entry->second;
    if (!is_new) continue;
    areas_.emplace_back();
    for (const std::size_t zone : of_cell) add(zones_[zone], frame, areas_.back());
  }
  prefer_lanes();
}

void DrivingRules::prefer_lanes() {
  prefers_ = std::ranges::any_of(areas_, [](const Area& area) { return area.is_lane; });
  if (!prefers_) return;
  for (Area& area : areas_) {
    if (!area.is_lane) area.slowness *= kBesideLanes;
  }
}

void DrivingRules::add(const DrawnZone& zone, const GridFrame& frame, Area& area) {
  if (zone.kind == ZoneKind::kSlow) {
    area.speed_mps = std::min(area.speed_mps.value_or(zone.value), zone.value);
    const double slowness = kUsualSpeed_m_s / std::max(*area.speed_mps, kLeastSpeed_m_s);
    area.slowness = static_cast<float>(std::max(1.0, slowness));
    return;
  }
  if (zone.kind == ZoneKind::kPreferred) {
    area.is_lane = true;
    return;
  }
  const auto [sin, cos] = geometry::sincos(zone.value - frame.T_map_grid.theta_rad);
  area.headings.emplace_back(cos, sin);
  for (std::size_t k = 0; k < grid_directions().size(); ++k) {
    if (along(area.headings.back(), grid_directions()[k])) continue;
    area.directions = static_cast<std::uint8_t>(area.directions & ~(1U << k));
  }
}

bool DrivingRules::allows(std::size_t index, const Eigen::Vector2d& direction) const {
  const std::vector<Eigen::Vector2d>& headings = areas_[area_[index]].headings;
  return std::ranges::all_of(
      headings, [&](const Eigen::Vector2d& heading) { return along(heading, direction); });
}

}  // namespace topogeo::planning
