// A uniform grid over the map frame of free, occupied and unknown cells (MACONDO, III.2;
// docs/algorithms.md, "Hybrid map and planner").
//
// Columns and rows count along x and y of the grid frame, whose origin is the lower left corner of
// cell (0, 0). The grid frame can be rotated in the map frame, as files of map_server allow.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::planning {

enum class CellState : std::uint8_t { kFree = 0, kOccupied = 1, kUnknown = 2 };

struct Cell {
  std::int32_t column = 0;
  std::int32_t row = 0;

  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Size and pose of a grid.
struct GridFrame {
  std::int32_t columns = 0;    ///< [1, 20000]
  std::int32_t rows = 0;       ///< [1, 20000]; columns x rows <= 1e8
  double resolution_m = 0.1;   ///< side of a cell, [0.01, 1]
  geometry::Pose2 T_map_grid;  ///< finite

  [[nodiscard]] std::size_t size() const {
    return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  }
  [[nodiscard]] bool contains(const Cell& cell) const {
    return cell.column >= 0 && cell.row >= 0 && cell.column < columns && cell.row < rows;
  }
  /// Row by row from row 0; the cell must lie inside.
  [[nodiscard]] std::size_t index(const Cell& cell) const {
    return static_cast<std::size_t>(cell.row) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(cell.column);
  }
  [[nodiscard]] Cell cell_at(std::size_t index) const {
    const auto width = static_cast<std::size_t>(columns);
    return {static_cast<std::int32_t>(index % width), static_cast<std::int32_t>(index / width)};
  }

  /// A point of the map frame in cells from the grid's origin; the middle of cell (0, 0) is
  /// (0.5, 0.5).
  [[nodiscard]] Eigen::Vector2d in_cells(const Eigen::Vector2d& point_m) const;

  /// The cell that contains a point of the map frame; empty outside and for points that are not
  /// finite.
  [[nodiscard]] std::optional<Cell> cell_of(const Eigen::Vector2d& point_m) const;

  /// Centre of a cell, map frame; also for cells outside.
  [[nodiscard]] Eigen::Vector2d center_m(const Cell& cell) const;
};

/// Throws std::invalid_argument naming the field, the value and the allowed range.
void check(const GridFrame& frame);

/// The frame of a grid of 0.1 m cells, parallel to the map frame, that extends `margin_m` beyond
/// all points (map frame; at least one). If a side would have more than 2,000 cells, they are
/// larger, up to 1 m.
GridFrame frame_around(std::span<const Eigen::Vector2d> points_m, double margin_m);

class OccupancyGrid {
 public:
  /// Sets every cell to `fill`. Throws std::invalid_argument like `check`.
  explicit OccupancyGrid(const GridFrame& frame, CellState fill = CellState::kUnknown);

  [[nodiscard]] const GridFrame& frame() const { return frame_; }

  /// The cell must lie inside.
  [[nodiscard]] CellState at(const Cell& cell) const { return cells_[frame_.index(cell)]; }
  void set(const Cell& cell, CellState state) { cells_[frame_.index(cell)] = state; }

  /// Row by row from row 0.
  [[nodiscard]] std::span<const CellState> cells() const { return cells_; }

 private:
  GridFrame frame_;
  std::vector<CellState> cells_;
};

}  // namespace topogeo::planning
