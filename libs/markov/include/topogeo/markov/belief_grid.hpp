// The state of Markov localization: probabilities of a square window of cells around the expected
// cell of the robot, in two buffers (MACONDO, III.1).
//
// The axes of the window are those of the map. The window follows the expected position in whole
// cells; a cell at offset (dx, dy) means that the robot is that many cells from its expected
// position, wherever within its cell that is. So rounding to cells never adds up along a route.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "topogeo/markov/obstacle_cells.hpp"

namespace topogeo::markov {

class BeliefGrid {
 public:
  static constexpr int kSmallest = 5;
  static constexpr int kLargest = 101;

  /// All zero, around cell (0, 0). Throws std::invalid_argument unless `size`, the cells of a side,
  /// is odd and within [5, 101].
  explicit BeliefGrid(int size = 21);

  [[nodiscard]] int size() const { return size_; }
  [[nodiscard]] int half() const { return size_ / 2; }
  /// Cell of the map in the middle: the expected one.
  [[nodiscard]] Cell centre() const { return centre_; }

  /// Probability of the cell at an offset from the centre; zero outside the window.
  [[nodiscard]] double at(Cell offset) const;
  /// Sets one probability. Throws std::out_of_range outside the window.
  void set(Cell offset, double probability);

  /// size x size values, lowest row first, x within a row.
  [[nodiscard]] std::span<const double> current() const { return current_; }
  [[nodiscard]] std::span<double> current() { return current_; }
  [[nodiscard]] std::span<const double> previous() const { return previous_; }

  /// Swaps the buffers: current becomes previous, and the new current state is all zero.
  void begin_update();
  void clear();

  /// The robot moves as expected: the window moves with its probabilities.
  void carry_to(Cell centre) { centre_ = centre; }
  /// The robot does not move but is expected elsewhere: every probability stays at its cell of the
  /// map. Cells outside the new window are lost, new cells are zero.
  void recentre(Cell centre);

  /// Sets cells to zero that are not in the mask (rows of free_cells_of_window).
  void keep_only(std::span<const RowBits> mask);

  [[nodiscard]] double sum() const;
  /// Divides by the sum, so that it becomes one; returns the previous sum. All zero stays all zero.
  /// Probabilities below 1e-15 become zero: they have no effect, and slow denormal numbers never
  /// occur.
  double normalize();

 private:
  [[nodiscard]] bool in_window(Cell offset) const;
  [[nodiscard]] std::size_t index(Cell offset) const;

  int size_;
  Cell centre_{};
  std::vector<double> current_;
  std::vector<double> previous_;
};

}  // namespace topogeo::markov
