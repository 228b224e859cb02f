#include <algorithm>
#include <array>
#include <cmath>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/matching/place_field.hpp"

namespace topogeo::localization {

namespace {

constexpr double kMostFieldCells = 16777216.0;  // 16 MB of the 150 MB limit of a service
constexpr double kFullValue = 255.0;            // of a byte

}  // namespace

int KernelGrid::floor_to_int(double value) {
  return static_cast<int>(std::floor(std::clamp(value, -1e9, 1e9)));
}

KernelGrid::KernelGrid(std::span<const Eigen::Vector2d> points_m, double cell_m, double width_m,
                       double margin_m)
    : cell_m_(cell_m) {
  if (points_m.empty()) return;
  Eigen::Vector2d low = points_m.front();
  Eigen::Vector2d high = points_m.front();
  for (const Eigen::Vector2d& p : points_m) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  origin_m_ = low.array() - margin_m;
  const Eigen::Vector2d extent_m = (high - low).array() + 2.0 * margin_m;
  while (extent_m.x() / cell_m_ * (extent_m.y() / cell_m_) > kMostFieldCells) cell_m_ *= 1.25;
  columns_ = static_cast<int>(extent_m.x() / cell_m_) + 1;
  rows_ = static_cast<int>(extent_m.y() / cell_m_) + 1;
  cells_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);

  const int reach = static_cast<int>(width_m / cell_m_) + 1;
  for (const Eigen::Vector2d& p : points_m) {
    const int c = column(p.x());
    const int r = row(p.y());
    for (int y = std::max(0, r - reach); y <= std::min(rows_ - 1, r + reach); ++y) {
      for (int x = std::max(0, c - reach); x <= std::min(columns_ - 1, c + reach); ++x) {
        const double u = (centre_m(x, y) - p).squaredNorm() / (width_m * width_m);
        if (u >= 1.0) continue;
        const auto value =
            static_cast<std::uint8_t>(std::lround(kFullValue * (1.0 - u) * (1.0 - u)));
        std::uint8_t& cell =
            cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                   static_cast<std::size_t>(x)];
        cell = std::max(cell, value);
      }
    }
  }
}

double mean_kernel(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
                   const geometry::Pose2& T_map_robot) {
  if (points_m.empty()) return 0.0;
  const geometry::SinCos r = geometry::sincos(T_map_robot.theta_rad);
  int sum = 0;
  for (const Eigen::Vector2d& p : points_m) {
    sum += grid.at(T_map_robot.x_m + r.cos * p.x() - r.sin * p.y(),
                   T_map_robot.y_m + r.sin * p.x() + r.cos * p.y());
  }
  return sum / (kFullValue * static_cast<double>(points_m.size()));
}

Climbed climb(const KernelGrid& grid, std::span<const Eigen::Vector2d> points_m,
              const geometry::Pose2& T_start) {
  constexpr double kFirst_m = 0.12;
  constexpr double kFirst_rad = 0.0523598776;
  constexpr int kLevels = 4;
  constexpr int kStepsOfLevel = 6;
  Climbed best{T_start, mean_kernel(grid, points_m, T_start)};
  double scale = 1.0;
  for (int level = 0; level < kLevels; ++level, scale *= 0.5) {
    const double d = scale * kFirst_m;
    const double a = scale * kFirst_rad;
    for (int step = 0; step < kStepsOfLevel; ++step) {
      const geometry::Pose2 T = best.T_map_robot;
      const std::array<geometry::Pose2, 6> around{
          geometry::Pose2{T.x_m + d, T.y_m, T.theta_rad},
          {T.x_m - d, T.y_m, T.theta_rad},
          {T.x_m, T.y_m + d, T.theta_rad},
          {T.x_m, T.y_m - d, T.theta_rad},
          {T.x_m, T.y_m, geometry::wrap_angle(T.theta_rad + a)},
          {T.x_m, T.y_m, geometry::wrap_angle(T.theta_rad - a)}};
      const double before = best.value;
      for (const geometry::Pose2& pose : around) {
        const double value = mean_kernel(grid, points_m, pose);
        if (value > best.value) best = {pose, value};
      }
      if (!(best.value > before)) break;
    }
  }
  return best;
}

}  // namespace topogeo::localization
