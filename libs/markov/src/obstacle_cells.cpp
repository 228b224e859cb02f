#include "topogeo/markov/obstacle_cells.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "topogeo/support/check_range.hpp"

namespace topogeo::markov {
namespace {

void check(const CellsView& view, int cells_a_side) {
  support::check_range("CellsView.width", view.width, 1, 100000);
  support::check_range("CellsView.height", view.height, 1, 100000);
  support::check_range("CellsView.resolution_m", view.resolution_m, 0.01, 1.0);
  support::check_range("CellsView.origin_m.x", view.origin_m.x(), -1e6, 1e6);
  support::check_range("CellsView.origin_m.y", view.origin_m.y(), -1e6, 1e6);
  support::check_range("CellsView.cells_a_side", cells_a_side, 1, 100);
  support::check_range("CellsView.cells_a_side * resolution_m", cells_a_side * view.resolution_m,
                       0.01, 1.0);
  const auto cells = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
  if (view.occupied.size() != cells) {
    throw std::invalid_argument("CellsView.occupied has " + std::to_string(view.occupied.size()) +
                                " cells, must have width x height = " + std::to_string(cells));
  }
}

}  // namespace

ObstacleCells::ObstacleCells(const CellsView& view, int cells_a_side) {
  check(view, cells_a_side);
  width_ = (view.width + cells_a_side - 1) / cells_a_side;
  height_ = (view.height + cells_a_side - 1) / cells_a_side;
  cell_m_ = view.resolution_m * cells_a_side;
  origin_m_ = view.origin_m;
  words_a_row_ = (width_ + 63) / 64;
  words_.assign(static_cast<std::size_t>(words_a_row_) * static_cast<std::size_t>(height_), 0);
  std::size_t i = 0;
  for (int y = 0; y < view.height; ++y) {
    std::uint64_t* row =
        words_.data() + static_cast<std::ptrdiff_t>(y / cells_a_side) * words_a_row_;
    for (int x = 0; x < view.width; ++x, ++i) {
      if (view.occupied[i] == 0) continue;
      const int column = x / cells_a_side;
      row[column / 64] |= std::uint64_t{1} << (column % 64);
    }
  }
}

Cell ObstacleCells::cell_of(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d cells = (point_m - origin_m_) / cell_m_;
  const auto index = [](double value) {
    return static_cast<int>(std::floor(std::clamp(value, -1e9, 1e9)));
  };
  return {index(cells.x()), index(cells.y())};
}

Eigen::Vector2d ObstacleCells::place_in_cell(const Eigen::Vector2d& point_m) const {
  const Eigen::Vector2d cells = (point_m - origin_m_) / cell_m_;
  return {cells.x() - std::floor(cells.x()), cells.y() - std::floor(cells.y())};
}

Eigen::Vector2d ObstacleCells::centre_m(Cell cell) const {
  return origin_m_ + cell_m_ * Eigen::Vector2d{cell.x + 0.5, cell.y + 0.5};
}

std::uint64_t ObstacleCells::occupied_bits(int x, int y) const {
  if (y < 0 || y >= height_) return 0;
  const std::uint64_t* row = words_.data() + static_cast<std::ptrdiff_t>(y) * words_a_row_;
  const auto word = [&](int i) { return i >= 0 && i < words_a_row_ ? row[i] : std::uint64_t{0}; };
  const int first = x >> 6;  // rounds down, also for negative x
  const int shift = x & 63;
  if (shift == 0) return word(first);
  return (word(first) >> shift) | (word(first + 1) << (64 - shift));
}

std::uint64_t ObstacleCells::inside_bits(int x, int y) const {
  if (y < 0 || y >= height_ || x <= -64 || x >= width_) return 0;
  constexpr std::uint64_t kAll = ~std::uint64_t{0};
  std::uint64_t bits = kAll;
  if (x < 0) bits &= kAll << -x;
  if (width_ - x < 64) bits &= kAll >> (64 - (width_ - x));
  return bits;
}

void free_cells_of_window(const ObstacleCells& map, Cell centre, int size,
                          std::vector<RowBits>& rows) {
  rows.assign(static_cast<std::size_t>(size), RowBits{});
  const int half = size / 2;
  for (int row = 0; row < size; ++row) {
    for (int word = 0; 64 * word < size; ++word) {
      const int x = centre.x - half + 64 * word;
      const int y = centre.y - half + row;
      const int bits_left = size - 64 * word;
      const std::uint64_t within =
          bits_left >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits_left) - 1;
      rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(word)] =
          map.inside_bits(x, y) & ~map.occupied_bits(x, y) & within;
    }
  }
}

}  // namespace topogeo::markov
