// What drawn zones and lines demand of those who drive, cell by cell (docs/navigation.md, "Zones").
//
// Where zones overlap the strictest of each counts: the lowest speed, the directions that all
// allow.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/planning/drawn_line.hpp"
#include "topogeo/planning/drawn_zone.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

class DrivingRules {
 public:
  /// There are none.
  DrivingRules() = default;
  /// Those of no-go, slow and one-way zones, walls, openings and doors; rooms demand nothing.
  DrivingRules(const GridFrame& frame, std::span<const DrawnZone> zones,
               std::span<const DrawnLine> lines = {});

  /// The zones that demand something, in their order.
  [[nodiscard]] const std::vector<DrawnZone>& zones() const { return zones_; }
  [[nodiscard]] const std::vector<DrawnLine>& lines() const { return lines_; }
  /// Whether any cell has a speed or directions.
  [[nodiscard]] bool guides() const { return !area_.empty(); }

  /// Cells whose middle lies in a no-go zone, and those of walls.
  [[nodiscard]] const std::vector<Cell>& no_go() const { return no_go_; }
  /// Cells of walls alone.
  [[nodiscard]] const std::vector<Cell>& walls() const { return walls_; }
  /// Cells that openings and doors free, whatever the map has there.
  [[nodiscard]] const std::vector<Cell>& open() const { return open_; }

  // Of a cell by its index; only while guides().
  /// Equal for cells in the same slow and one-way zones; 0 for those in none.
  [[nodiscard]] std::uint32_t area(std::size_t index) const { return area_[index]; }
  /// How much longer a step takes here than elsewhere; >= 1.
  [[nodiscard]] float slowness(std::size_t index) const { return areas_[area_[index]].slowness; }
  /// In which of the eight directions one may drive: bit k is that of CellGraph.
  [[nodiscard]] std::uint8_t directions(std::size_t index) const {
    return areas_[area_[index]].directions;
  }
  /// Largest speed, where there is one.
  [[nodiscard]] std::optional<double> speed_mps(std::size_t index) const {
    return areas_[area_[index]].speed_mps;
  }
  /// Whether one may drive from there straight in this direction of the grid: none that turns more
  /// than 120 degrees from the heading of a one-way zone, so that it can be crossed.
  [[nodiscard]] bool allows(std::size_t index, const Eigen::Vector2d& direction) const;

 private:
  struct Area {
    float slowness = 1.0F;
    std::uint8_t directions = 0xFF;
    std::optional<double> speed_mps{};
    std::vector<Eigen::Vector2d> headings{};  // of one-way zones, in the frame of the grid
  };
  static void add(const DrawnZone& zone, const GridFrame& frame, Area& area);

  std::vector<DrawnZone> zones_;
  std::vector<DrawnLine> lines_;
  std::vector<Cell> no_go_;
  std::vector<Cell> walls_;
  std::vector<Cell> open_;
  std::vector<std::uint32_t> area_;  // by cell
  std::vector<Area> areas_;
};

}  // namespace topogeo::planning
