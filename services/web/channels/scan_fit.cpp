#include "channels/scan_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace topogeo::web {
namespace {

constexpr std::size_t kFewestHits = 25;
constexpr std::size_t kMostHits = 100;  // sampled
constexpr double kNear_m = 0.3;

bool is_near_wall(const MapPicture& map, const planning::Cell& at, std::int32_t reach) {
  const planning::GridFrame& frame = map.frame();
  for (std::int32_t row = at.row - reach; row <= at.row + reach; ++row) {
    for (std::int32_t column = at.column - reach; column <= at.column + reach; ++column) {
      const planning::Cell cell{column, row};
      if (frame.contains(cell) && map.state_at(cell) == planning::CellState::kOccupied) return true;
    }
  }
  return false;
}

}  // namespace

std::optional<double> scan_fit(const MapPicture& map, const geometry::Pose2& T_map_robot,
                               const std::vector<Eigen::Vector2d>& hits_m) {
  if (hits_m.size() < kFewestHits) return std::nullopt;
  const auto reach = static_cast<std::int32_t>(std::ceil(kNear_m / map.frame().resolution_m));
  const std::size_t step = std::max<std::size_t>(1, hits_m.size() / kMostHits);
  std::size_t all = 0;
  std::size_t near = 0;
  for (std::size_t i = 0; i < hits_m.size(); i += step) {
    ++all;
    const auto cell = map.frame().cell_of(T_map_robot * hits_m[i]);
    if (cell && is_near_wall(map, *cell, reach)) ++near;
  }
  return static_cast<double>(near) / static_cast<double>(all);
}

void ScanFit::add(double fit) {
  misfits_ = fit < kLeast ? misfits_ + 1 : 0;
  last_ = misfits_ < kScans;
}

}  // namespace topogeo::web
