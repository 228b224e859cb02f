// Driving rules of drawn zones and lines, cell by cell (docs/navigation.md, "Zones").
//
// If zones overlap, the strictest rule counts: the lowest speed, and the directions that all of
// them allow.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/drawn_zone.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// Whether a one-way zone allows driving straight in this direction of the map frame.
bool may_drive(const DrawnZone& one_way, const Eigen::Vector2d& direction_m);

class DrivingRules {
 public:
  /// No rules.
  DrivingRules() = default;
  /// Rules of no-go, slow and one-way zones, preferred lanes, walls, openings and doors; rooms have
  /// none.
  DrivingRules(const GridFrame& frame, std::span<const DrawnZone> zones,
               std::span<const DrawnLine> lines = {});

  /// The zones with rules, in their order.
  [[nodiscard]] const std::vector<DrawnZone>& zones() const { return zones_; }
  [[nodiscard]] const std::vector<DrawnLine>& lines() const { return lines_; }
  /// Whether any cell has a speed limit, forbidden directions or a preferred lane.
  [[nodiscard]] bool guides() const { return !area_.empty(); }
  /// Whether there is a preferred lane, so that steps beside it cost more.
  [[nodiscard]] bool prefers() const { return prefers_; }
  /// slowness() of cells outside of all zones and of the frame.
  [[nodiscard]] float usual_slowness() const { return areas_.empty() ? 1.0F : areas_[0].slowness; }

  /// Cells whose middle lies in a no-go zone, and those of walls.
  [[nodiscard]] const std::vector<Cell>& no_go() const { return no_go_; }
  /// Cells of walls only.
  [[nodiscard]] const std::vector<Cell>& walls() const { return walls_; }
  /// Cells that openings and doors free, whatever their state on the map.
  [[nodiscard]] const std::vector<Cell>& open() const { return open_; }

  // Properties of a cell by its index; valid only if guides().
  /// Equal for cells in the same slow and one-way zones and preferred lanes; 0 outside of them.
  [[nodiscard]] std::uint32_t area(std::size_t index) const { return area_[index]; }
  /// Factor by which a step costs more here, because it takes longer or is beside the lanes; >= 1.
  [[nodiscard]] float slowness(std::size_t index) const { return areas_[area_[index]].slowness; }
  /// The allowed ones of the eight directions: bit k is direction k of CellGraph.
  [[nodiscard]] std::uint8_t directions(std::size_t index) const {
    return areas_[area_[index]].directions;
  }
  /// Largest speed, if limited.
  [[nodiscard]] std::optional<double> speed_mps(std::size_t index) const {
    return areas_[area_[index]].speed_mps;
  }
  /// Whether one may drive straight from there in this direction of the grid: forbids directions
  /// more than 120 degrees off the heading of a one-way zone, so that it can be crossed.
  [[nodiscard]] bool allows(std::size_t index, const Eigen::Vector2d& direction) const;

 private:
  struct Area {
    float slowness = 1.0F;
    std::uint8_t directions = 0xFF;
    std::optional<double> speed_mps{};
    bool is_lane = false;
    std::vector<Eigen::Vector2d> headings{};  // of one-way zones, in the grid frame
  };
  static void add(const DrawnZone& zone, const GridFrame& frame, Area& area);
  void prefer_lanes();

  std::vector<DrawnZone> zones_;
  std::vector<DrawnLine> lines_;
  std::vector<Cell> no_go_;
  std::vector<Cell> walls_;
  std::vector<Cell> open_;
  std::vector<std::uint32_t> area_;  // by cell
  std::vector<Area> areas_;
  bool prefers_ = false;
};

}  // namespace topogeo::planning
