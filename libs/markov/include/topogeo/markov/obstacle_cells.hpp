// The obstacles of a known environment as cells, packed one bit per cell, so that a few word
// operations test a row of the window (MACONDO, III.1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace topogeo::markov {

/// Indices of a cell, or a difference of two; x and y along the axes of the map.
struct Cell {
  int x = 0;
  int y = 0;
  friend bool operator==(const Cell&, const Cell&) = default;
};

/// Cells of a grid that the caller owns.
struct CellsView {
  int width = 0;
  int height = 0;
  double resolution_m = 0.0;
  Eigen::Vector2d origin_m = Eigen::Vector2d::Zero();  ///< outer corner of cell (0, 0), map frame
  /// width x height, row after row, x within a row; any value except 0 is an obstacle.
  std::span<const std::uint8_t> occupied;
};

class ObstacleCells {
 public:
  /// Copies the cells. `cells_a_side` squared of them become one, which is an obstacle if any of
  /// them is (2 turns cells of 5 cm into cells of 10 cm); an incomplete last row or column becomes
  /// one more. Throws std::invalid_argument naming the field: sides not in [1, 100000], a cell not
  /// in [0.01, 1] m, an origin that is not finite, `occupied` of another size, `cells_a_side` not
  /// in [1, 100].
  explicit ObstacleCells(const CellsView& view, int cells_a_side = 1);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] double cell_m() const { return cell_m_; }
  /// Outer corner of cell (0, 0), map frame.
  [[nodiscard]] const Eigen::Vector2d& origin_m() const { return origin_m_; }

  [[nodiscard]] bool inside(Cell cell) const {
    return cell.x >= 0 && cell.x < width_ && cell.y >= 0 && cell.y < height_;
  }
  /// False outside the map.
  [[nodiscard]] bool occupied(Cell cell) const {
    return inside(cell) && (occupied_bits(cell.x, cell.y) & 1U) != 0;
  }
  /// Possible cell of the robot: within the map and no obstacle.
  [[nodiscard]] bool free(Cell cell) const { return inside(cell) && !occupied(cell); }

  /// The cell that contains a point of the map frame; may be outside. A coordinate further than 1e9
  /// cells from the origin counts as 1e9 cells away.
  [[nodiscard]] Cell cell_of(const Eigen::Vector2d& point_m) const;
  /// Position of a point within its cell, in cells, [0, 1) both.
  [[nodiscard]] Eigen::Vector2d place_in_cell(const Eigen::Vector2d& point_m) const;
  [[nodiscard]] Eigen::Vector2d centre_m(Cell cell) const;

  /// Bit i: whether cell (x + i, y) is an obstacle; 0 outside the map.
  [[nodiscard]] std::uint64_t occupied_bits(int x, int y) const;
  /// Bit i: whether cell (x + i, y) is within the map.
  [[nodiscard]] std::uint64_t inside_bits(int x, int y) const;

 private:
  int width_ = 0;
  int height_ = 0;
  double cell_m_ = 0.0;
  Eigen::Vector2d origin_m_ = Eigen::Vector2d::Zero();
  int words_a_row_ = 0;
  std::vector<std::uint64_t> words_;
};

/// One row of a window of up to 101 cells: bit i of word i / 64 is the cell i from the left.
using RowBits = std::array<std::uint64_t, 2>;

inline bool bit_of(const RowBits& row, int column) {
  const auto i = static_cast<std::size_t>(column);
  return ((row[i / 64] >> (i % 64)) & 1U) != 0;
}

/// Free cells of the window of `size` x `size` cells around `centre`; lowest row first. `size` is
/// odd, at most 127; `rows` keeps its capacity.
void free_cells_of_window(const ObstacleCells& map, Cell centre, int size,
                          std::vector<RowBits>& rows);

}  // namespace topogeo::markov
