// Cheapest paths over the cells of a window of the grid: A* to one cell, or one search to many.
//
// Eight neighbours; a step costs its length in cells, 1 or the root of 2. A diagonal step needs
// both cells beside it open, so no path cuts a corner. If zones are obeyed, slow ones raise the
// cost of a step in proportion, and no step goes in a direction that either of its cells forbids.
// The searches use Boost.Graph on an implicit graph: the mask of open cells gives the neighbours.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::planning {

/// A rectangle of cells, both corners included.
struct CellBox {
  Cell low;
  Cell high;

  [[nodiscard]] bool contains(const Cell& cell) const {
    return cell.column >= low.column && cell.row >= low.row && cell.column <= high.column &&
           cell.row <= high.row;
  }
};

/// The part of the grid in a box extended by `cells` on every side. The box must overlap the grid.
CellBox grown(const CellBox& box, std::int32_t cells, const GridFrame& frame);

/// The whole grid.
CellBox whole(const GridFrame& frame);

/// The cells of a box that a search may enter.
class SearchWindow {
 public:
  /// Whether a search obeys the speeds and directions of FreeSpace::rules().
  enum class Rules : std::uint8_t { kIgnored, kObeyed };

  /// The passable cells of the box, which must lie in the grid.
  SearchWindow(const FreeSpace& space, const CellBox& box, Rules rules = Rules::kIgnored);

  /// The cells of the box with the label `label`; one label for each cell of the grid.
  SearchWindow(const GridFrame& frame, const CellBox& box, std::span<const std::uint16_t> labels,
               std::uint16_t label);

  [[nodiscard]] const CellBox& box() const { return box_; }

  [[nodiscard]] bool open(const Cell& cell) const {
    return box_.contains(cell) && mask_[index(cell)] != 0;
  }

  /// Ignores cells outside of the box.
  void close(const Cell& cell);

  /// Lets each cell of the box cost `slowness` times its length, >= 0; one value for each cell of
  /// the grid. With values below 1 the estimate of shortest_path() is no lower bound.
  void set_slowness(const GridFrame& frame, std::span<const float> slowness);

  /// Closes the cells whose centre is at most `radius_cells` from that of `cell`.
  void close_disc(const Cell& cell, double radius_cells);

  // Search interface: cells by number, in rows with a closed cell at each end.
  [[nodiscard]] std::uint32_t index(const Cell& cell) const {
    return static_cast<std::uint32_t>(cell.row - box_.low.row + 1) * stride_ +
           static_cast<std::uint32_t>(cell.column - box_.low.column + 1);
  }
  [[nodiscard]] Cell cell_at(std::uint32_t index) const {
    return {static_cast<std::int32_t>(index % stride_) + box_.low.column - 1,
            static_cast<std::int32_t>(index / stride_) + box_.low.row - 1};
  }
  [[nodiscard]] std::uint32_t stride() const { return stride_; }
  [[nodiscard]] const std::vector<std::uint8_t>& mask() const { return mask_; }
  /// Indexed like the mask; empty without rules.
  [[nodiscard]] const std::vector<float>& slowness() const { return slowness_; }
  [[nodiscard]] const std::vector<std::uint8_t>& directions() const { return directions_; }

 private:
  CellBox box_;
  std::uint32_t stride_ = 0;
  std::vector<std::uint8_t> mask_;
  std::vector<float> slowness_{};
  std::vector<std::uint8_t> directions_{};
};

struct CellPath {
  std::vector<Cell> cells;  ///< in order, >= 1
  double cost_cells = 0.0;  ///< length between the cell centres, in cells
};

/// Length of a path over neighbouring cells, in cells.
double cost_cells(std::span<const Cell> cells);

/// Length of the shortest path between two cells without obstacles (octile distance), in cells.
double least_cost_cells(const Cell& a, const Cell& b);

/// The cheapest path by A* with the octile distance as its estimate; empty if there is none or one
/// of the two cells is not open.
std::optional<CellPath> shortest_path(const SearchWindow& window, const Cell& from, const Cell& to);

/// The cheapest paths to each of several cells, by one search that ends when all are reached, at
/// the cost of a single one.
std::vector<std::optional<CellPath>> shortest_paths(const SearchWindow& window, const Cell& from,
                                                    std::span<const Cell> to);

/// The cheapest path to the cell among `to` that costs least; empty if none is reached.
std::optional<CellPath> path_to_nearest(const SearchWindow& window, const Cell& from,
                                        std::span<const Cell> to);

/// The cells that a path over the window leads to, `from` included; one value for each cell of the
/// grid.
std::vector<bool> reached_cells(const SearchWindow& window, const GridFrame& frame,
                                const Cell& from);

}  // namespace topogeo::planning
