#include "topogeo/markov/cone_ranges.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/check_range.hpp"

namespace topogeo::markov {
namespace {

constexpr double kBearing_rad = 2.0 * std::numbers::pi / ConeRanges::kBearings;
/// 58 MB of tables; a robot needs a thousand per place, so making them again costs little.
constexpr std::size_t kMostTables = 120'000;

}  // namespace

ConeRanges::ConeRanges(const ObstacleCells& map, double half_cone_rad, double max_range_m)
    : map_(map), max_range_m_(max_range_m), step_m_(0.5 * map.cell_m()) {
  support::check_range("half_cone_rad", half_cone_rad, 0.0, 0.5 * std::numbers::pi, "rad");
  support::check_range("max_range_m", max_range_m, 0.01, 60.0, "m");
  half_bearings_ = static_cast<int>(std::lround(half_cone_rad / kBearing_rad));
  columns_ = 2 * map.width();
  rows_ = 2 * map.height();
  table_of_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
}

int ConeRanges::bearing_index(double bearing_rad) {
  const auto index = static_cast<int>(std::lround(bearing_rad / kBearing_rad)) % kBearings;
  return index < 0 ? index + kBearings : index;
}

std::uint16_t ConeRanges::range_mm(const Eigen::Vector2d& from_m, int bearing) {
  const Eigen::Vector2d at = (from_m - map_.origin_m()) / step_m_;
  const int x = static_cast<int>(std::floor(std::clamp(at.x(), -1.0, columns_ + 0.0)));
  const int y = static_cast<int>(std::floor(std::clamp(at.y(), -1.0, rows_ + 0.0)));
  if (x < 0 || y < 0 || x >= columns_ || y >= rows_) {
    return static_cast<std::uint16_t>(std::lround(1000.0 * max_range_m_));
  }
  std::int32_t& table = table_of_[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) +
                                  static_cast<std::size_t>(x)];
  if (table < 0) {
    if (tables_.size() >= kMostTables) {
      tables_.clear();
      std::fill(table_of_.begin(), table_of_.end(), -1);
    }
    table = static_cast<std::int32_t>(tables_.size());
    tables_.push_back(make(x, y));
  }
  return tables_[static_cast<std::size_t>(table)][static_cast<std::size_t>(bearing)];
}

ConeRanges::Table ConeRanges::make(int x, int y) const {
  const Eigen::Vector2d from_cells(0.5 * (x + 0.5), 0.5 * (y + 0.5));
  Table rays;
  for (int i = 0; i < kBearings; ++i) {
    rays[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(
        std::lround(1000.0 * std::min(max_range_m_, ray_m(from_cells, i * kBearing_rad))));
  }
  Table cones = rays;
  for (int i = 0; i < kBearings; ++i) {
    for (int off = -half_bearings_; off <= half_bearings_; ++off) {
      const int ray = (i + off + 2 * kBearings) % kBearings;
      cones[static_cast<std::size_t>(i)] =
          std::min(cones[static_cast<std::size_t>(i)], rays[static_cast<std::size_t>(ray)]);
    }
  }
  return cones;
}

double ConeRanges::ray_m(const Eigen::Vector2d& from_cells, double bearing_rad) const {
  const geometry::SinCos direction = geometry::sincos(bearing_rad);
  const double most_cells = max_range_m_ / map_.cell_m();
  Cell cell{static_cast<int>(std::floor(from_cells.x())),
            static_cast<int>(std::floor(from_cells.y()))};
  if (map_.occupied(cell)) return 0.0;
  const auto border = [](double at, double along) {
    constexpr double kNever = 1e9;
    if (std::fabs(along) < 1e-12) return std::pair(kNever, kNever);
    const double below = std::floor(at);
    const double first = along < 0.0 ? at - below : below + 1.0 - at;
    return std::pair(first / std::fabs(along), 1.0 / std::fabs(along));
  };
  auto [next_x, between_x] = border(from_cells.x(), direction.cos);
  auto [next_y, between_y] = border(from_cells.y(), direction.sin);
  double entered = 0.0;
  while (entered <= most_cells) {
    if (next_x < next_y) {
      cell.x += direction.cos < 0.0 ? -1 : 1;
      entered = next_x;
      next_x += between_x;
    } else {
      cell.y += direction.sin < 0.0 ? -1 : 1;
      entered = next_y;
      next_y += between_y;
    }
    if (map_.occupied(cell)) return 0.5 * (entered + std::min(next_x, next_y)) * map_.cell_m();
  }
  return max_range_m_;
}

}  // namespace topogeo::markov
