#include "topogeo/markov/belief_grid.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace topogeo::markov {

BeliefGrid::BeliefGrid(int size) : size_(size) {
  if (size < kSmallest || size > kLargest || size % 2 == 0) {
    throw std::invalid_argument("window of " + std::to_string(size) +
                                " cells: must be odd and in [" + std::to_string(kSmallest) + ", " +
                                std::to_string(kLargest) + "]");
  }
  const auto cells = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  current_.assign(cells, 0.0);
  previous_.assign(cells, 0.0);
}

bool BeliefGrid::in_window(Cell offset) const {
  return offset.x >= -half() && offset.x <= half() && offset.y >= -half() && offset.y <= half();
}

std::size_t BeliefGrid::index(Cell offset) const {
  return static_cast<std::size_t>(offset.y + half()) * static_cast<std::size_t>(size_) +
         static_cast<std::size_t>(offset.x + half());
}

double BeliefGrid::at(Cell offset) const {
  return in_window(offset) ? current_[index(offset)] : 0.0;
}

void BeliefGrid::set(Cell offset, double probability) {
  if (!in_window(offset)) {
    throw std::out_of_range("cell (" + std::to_string(offset.x) + ", " + std::to_string(offset.y) +
                            ") is outside the window of " + std::to_string(size_) + " cells");
  }
  current_[index(offset)] = probability;
}

void BeliefGrid::begin_update() {
  current_.swap(previous_);
  std::fill(current_.begin(), current_.end(), 0.0);
}

void BeliefGrid::clear() {
  std::fill(current_.begin(), current_.end(), 0.0);
  std::fill(previous_.begin(), previous_.end(), 0.0);
}

void BeliefGrid::recentre(Cell centre) {
  // 64 bits: the difference of two extreme centres exceeds 32 bits.
  const std::int64_t by_x = std::int64_t{centre.x} - centre_.x;
  const std::int64_t by_y = std::int64_t{centre.y} - centre_.y;
  centre_ = centre;
  begin_update();
  if (std::abs(by_x) >= size_ || std::abs(by_y) >= size_) return;
  const auto dx = static_cast<int>(by_x);
  const auto dy = static_cast<int>(by_y);
  for (int y = -half(); y <= half(); ++y) {
    for (int x = -half(); x <= half(); ++x) {
      const Cell from{x + dx, y + dy};
      if (in_window(from)) current_[index({x, y})] = previous_[index(from)];
    }
  }
}

void BeliefGrid::keep_only(std::span<const RowBits> mask) {
  double* cell = current_.data();
  for (int row = 0; row < size_; ++row) {
    const RowBits& bits = mask[static_cast<std::size_t>(row)];
    for (int column = 0; column < size_; ++column, ++cell) {
      if (!bit_of(bits, column)) *cell = 0.0;
    }
  }
}

double BeliefGrid::sum() const {
  double sum = 0.0;
  for (const double probability : current_) sum += probability;
  return sum;
}

double BeliefGrid::normalize() {
  constexpr double kNegligible = 1e-15;
  const double before = sum();
  if (before <= 0.0) return 0.0;
  double kept = 0.0;
  for (double& probability : current_) {
    if (probability < kNegligible * before) probability = 0.0;
    kept += probability;
  }
  for (double& probability : current_) probability /= kept;
  return before;
}

}  // namespace topogeo::markov
