#include "channels/scan_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::web {
namespace {

/// A room of 6 x 4 m with walls, its lower left inner corner at 2, 2 m, on 10 x 10 m.
MapPicture room() {
  constexpr std::int32_t kCells = 200;
  planning::GridFrame frame;
  frame.columns = frame.rows = kCells;
  frame.resolution_m = 0.05;
  constexpr std::int32_t kSide = MapPicture::kSquareCells;
  constexpr std::int32_t kSquares = (kCells + kSide - 1) / kSide;
  std::vector<std::shared_ptr<const GridSquare>> squares;
  for (std::int32_t number = 0; number < kSquares * kSquares; ++number) {
    auto square = std::make_shared<GridSquare>();
    square->states.resize(std::size_t{kSide} * kSide);
    square->zones.resize(square->states.size(), 65535);
    for (std::int32_t row = 0; row < kSide; ++row) {
      for (std::int32_t column = 0; column < kSide; ++column) {
        const std::int32_t from_column = number % kSquares * kSide;
        const std::int32_t from_row = number / kSquares * kSide;
        const double x_m = 0.05 * (from_column + column);
        const double y_m = 0.05 * (from_row + row);
        const bool inside = x_m > 2.0 && x_m < 8.0 && y_m > 2.0 && y_m < 6.0;
        const bool around = x_m > 1.9 && x_m < 8.1 && y_m > 1.9 && y_m < 6.1;
        const planning::CellState state =
            inside ? planning::CellState::kFree
                   : (around ? planning::CellState::kOccupied : planning::CellState::kUnknown);
        const std::int32_t cell = row * kSide + column;
        square->states.at(static_cast<std::size_t>(cell)) = static_cast<std::uint8_t>(state);
      }
    }
    squares.push_back(std::move(square));
  }
  return {frame, squares, {}};
}

/// Hits all around from the middle of the room, robot frame.
std::vector<Eigen::Vector2d> hits() {
  std::vector<Eigen::Vector2d> hits_m;
  for (int i = 0; i < 180; ++i) {
    const double angle = i * std::numbers::pi / 90.0;
    const double to_side_m = 3.0 / std::max(std::fabs(std::cos(angle)), 1e-9);
    const double to_end_m = 2.0 / std::max(std::fabs(std::sin(angle)), 1e-9);
    const double range_m = std::min(to_side_m, to_end_m);
    hits_m.emplace_back(range_m * std::cos(angle), range_m * std::sin(angle));
  }
  return hits_m;
}

TEST(ScanFit, AScanFitsWhereItWasTakenAndNotElsewhere) {
  const MapPicture map = room();
  EXPECT_GT(scan_fit(map, {5.0, 4.0, 0.0}, hits()).value(), 0.95);
  EXPECT_GT(scan_fit(map, {5.1, 4.1, 0.02}, hits()).value(), 0.9);
  EXPECT_LT(scan_fit(map, {25.0, 4.0, 0.0}, hits()).value(), 0.01) << "20 m off, outside";
  EXPECT_LT(scan_fit(map, {2.5, 8.5, 0.7}, hits()).value(), ScanFit::kLeast);
  EXPECT_FALSE(scan_fit(map, {5.0, 4.0, 0.0}, {{1.0, 0.0}})) << "too few hits";
}

TEST(ScanFit, OneScanProvesNothing) {
  ScanFit fit;
  EXPECT_EQ(fit.last(), std::nullopt);
  const auto after = [&](double share) {
    fit.add(share);
    return fit.last().value();
  };
  EXPECT_TRUE(after(0.0));
  EXPECT_TRUE(after(0.0));
  EXPECT_FALSE(after(0.1));
  EXPECT_FALSE(after(0.1));
  EXPECT_TRUE(after(0.8));
  EXPECT_TRUE(after(0.0));
}

TEST(ScanFit, AVerdictStaysUntilAnotherOneOrUntilItIsForgotten) {
  ScanFit fit;
  for (int i = 0; i < 3; ++i) fit.add(0.0);
  EXPECT_EQ(fit.last(), false);
  EXPECT_EQ(fit.last(), false);
  fit.forget();
  EXPECT_EQ(fit.last(), std::nullopt);
}

}  // namespace
}  // namespace topogeo::web
