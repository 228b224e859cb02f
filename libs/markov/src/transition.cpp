#include "topogeo/markov/transition.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <string>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::markov {
namespace {

void check_side(const std::string& key, const char* side, int cells) {
  if (cells < 1 || cells > 21 || cells % 2 == 0) {
    support::refuse_value(key, cells, std::string("an odd number of ") + side + " from 1 to 21");
  }
}

void check_matrix(const std::string& key, const TransitionMatrix& matrix) {
  check_side(key, "rows", matrix.rows);
  check_side(key, "columns", matrix.columns);
  const auto cells =
      static_cast<std::size_t>(matrix.rows) * static_cast<std::size_t>(matrix.columns);
  if (matrix.values.size() != cells) {
    support::refuse_value(key, static_cast<double>(matrix.values.size()),
                          std::to_string(cells) + " values");
  }
  double sum = 0.0;
  for (const double value : matrix.values) {
    support::require_between(key, value, 0.0, 1.01, "");
    sum += value;
  }
  if (!(sum >= 0.1 && sum <= 1.01)) support::refuse_value(key, sum, "a sum between 0.1 and 1.01");
}

/// Values on a square of cells around the expected place, converted to taps.
class TapSquare {
 public:
  explicit TapSquare(int half)
      : half_(half), values_(static_cast<std::size_t>((2 * half + 1) * (2 * half + 1)), 0.0) {}

  void add(Cell offset, double probability) {
    const std::ptrdiff_t side = 2 * half_ + 1;
    const std::ptrdiff_t cell = (offset.y + half_) * side + offset.x + half_;
    values_[static_cast<std::size_t>(cell)] += probability;
  }

  void share(double x, double y, double probability) {
    const double left = std::floor(x);
    const double low = std::floor(y);
    const double right_part = x - left;
    const double high_part = y - low;
    const Cell corner{static_cast<int>(left), static_cast<int>(low)};
    add(corner, probability * (1.0 - right_part) * (1.0 - high_part));
    add({corner.x + 1, corner.y}, probability * right_part * (1.0 - high_part));
    add({corner.x, corner.y + 1}, probability * (1.0 - right_part) * high_part);
    add({corner.x + 1, corner.y + 1}, probability * right_part * high_part);
  }

  [[nodiscard]] std::vector<Tap> taps() const {
    std::vector<Tap> taps;
    std::size_t i = 0;
    for (int y = -half_; y <= half_; ++y) {
      for (int x = -half_; x <= half_; ++x, ++i) {
        if (values_[i] > 0.0) taps.push_back({{x, y}, values_[i]});
      }
    }
    return taps;
  }

 private:
  int half_;
  std::vector<double> values_;
};

/// A cell (ahead, left) of the robot after quarter turns counter-clockwise.
Cell quarter_turned(Cell cell, int quarters) {
  for (int i = 0; i < quarters; ++i) cell = {-cell.y, cell.x};
  return cell;
}

}  // namespace

TransitionMatrix macondo_advance() {
  return {3, 3, {0.0, 0.0625, 0.0078, 0.0, 0.7929, 0.0625, 0.0, 0.0625, 0.0078}};
}

TransitionMatrix quarter_turn() {
  return {3, 3, {0.005, 0.02, 0.005, 0.02, 0.9, 0.02, 0.005, 0.02, 0.005}};
}

void check(const TransitionModel& model) {
  check_matrix("markov.advance_matrix", model.advance);
  check_matrix("markov.left_matrix", model.left);
  check_matrix("markov.right_matrix", model.right);
  if (model.advance_step_m != 0.0)
    support::require_between("markov.advance_step_m", model.advance_step_m, 0.01, 100.0, "m");
  if (model.turn_step_rad != 0.0)
    support::require_between("markov.turn_step_rad", model.turn_step_rad, 0.01, 6.3, "rad");
}

std::vector<Tap> turned(const TransitionMatrix& matrix, ArrowSense sense, double heading_rad) {
  constexpr double kQuarter_rad = 0.5 * std::numbers::pi;
  constexpr double kSame_rad = 1e-9;  // error after many turns by quarters
  const double quarters = std::round(heading_rad / kQuarter_rad);
  const bool exact = std::abs(heading_rad - quarters * kQuarter_rad) < kSame_rad;
  const int quarters_in_turn = (static_cast<int>(quarters) % 4 + 4) % 4;
  const geometry::SinCos direction = geometry::sincos(heading_rad);

  // A turned cell is at most half_rows + half_columns away and shared with the next one.
  TapSquare square{matrix.rows / 2 + matrix.columns / 2 + 1};
  std::size_t i = 0;
  for (int row = 0; row < matrix.rows; ++row) {
    for (int column = 0; column < matrix.columns; ++column, ++i) {
      const int right = column - matrix.columns / 2;
      const Cell cell{sense == ArrowSense::kRight ? right : -right, matrix.rows / 2 - row};
      if (matrix.values[i] == 0.0) continue;
      if (exact) {
        square.add(quarter_turned(cell, quarters_in_turn), matrix.values[i]);
      } else {
        square.share(cell.x * direction.cos - cell.y * direction.sin,
                     cell.x * direction.sin + cell.y * direction.cos, matrix.values[i]);
      }
    }
  }
  return square.taps();
}

std::vector<Tap> part_of(const std::vector<Tap>& taps, double part) {
  std::vector<Tap> result = taps;
  for (Tap& tap : result) tap.probability *= part;
  if (part < 1.0) result.push_back({{0, 0}, 1.0 - part});
  return result;
}

double spread(std::span<const Tap> taps, std::span<const RowBits> free, BeliefGrid& grid) {
  grid.begin_update();
  const std::span<const double> from = grid.previous();
  const std::span<double> to = grid.current();
  const int size = grid.size();
  for (const Tap& tap : taps) {
    // Below, x and y are those of the cell that the probability comes from.
    const auto [dx, dy] = tap.offset;
    const int first_x = std::max(0, -dx);
    const int end_x = size - std::max(0, dx);
    for (int y = std::max(0, -dy); y < size - std::max(0, dy); ++y) {
      const double* source = from.data() + static_cast<std::ptrdiff_t>(y) * size;
      double* target = to.data() + static_cast<std::ptrdiff_t>(y + dy) * size + dx;
      for (int x = first_x; x < end_x; ++x) target[x] += tap.probability * source[x];
    }
  }
  grid.keep_only(free);
  return grid.sum();
}

}  // namespace topogeo::markov
