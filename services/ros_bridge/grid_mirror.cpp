#include "grid_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/grid.hpp"

namespace topogeo::ros_bridge {
namespace {

constexpr std::uint32_t kSide = msg::kTileCells;

void need(bool good, const std::string& field, const std::string& expected) {
  if (!good) throw std::invalid_argument(field + ": expected " + expected);
}

std::uint32_t tiles_across(std::uint32_t cells) {
  return (cells + kSide - 1) / kSide;
}

bool same_frame(const msg::HybridMap& a, const msg::HybridMap& b) {
  return a.columns() == b.columns() && a.rows() == b.rows() &&
         a.resolution_m() == b.resolution_m() && a.T_map_grid() == b.T_map_grid();
}

geometry::Pose2 origin_of(const msg::HybridMap& map) {
  return {map.T_map_grid().x_m(), map.T_map_grid().y_m(), map.T_map_grid().theta_rad()};
}

}  // namespace

void GridMirror::put(const msg::GridTile& tile, messaging::Handle instance) {
  need(tile.tile() < msg::kMaxTiles, "tile", "less than " + std::to_string(msg::kMaxTiles));
  need(tile.states().size() == msg::kTileArea, "states", std::to_string(msg::kTileArea));
  need(tile.zones().size() == msg::kTileArea, "zones", std::to_string(msg::kTileArea));
  Tile& kept = tiles_[tile.tile()];
  kept.version = tile.version();
  kept.cells.resize(msg::kTileArea);
  std::ranges::transform(tile.states(), kept.cells.begin(), ros::cell_of);
  kept.zones = tile.zones();
  keys_[instance] = tile.tile();
}

void GridMirror::put(const msg::HybridMap& summary) {
  const std::uint64_t tiles =
      static_cast<std::uint64_t>(tiles_across(summary.columns())) * tiles_across(summary.rows());
  need(summary.columns() > 0 && summary.rows() > 0 && tiles <= msg::kMaxTiles, "columns and rows",
       "1 to " + std::to_string(msg::kMaxTiles) + " tiles");
  need(summary.tile_versions().size() == tiles, "tile_versions", std::to_string(tiles));
  const msg::Pose2& origin = summary.T_map_grid();
  need(std::isfinite(origin.x_m()) && std::isfinite(origin.y_m()) &&
           std::isfinite(origin.theta_rad()) && std::isfinite(summary.resolution_m()) &&
           summary.resolution_m() > 0.0,
       "T_map_grid and resolution_m", "finite numbers");
  summary_ = summary;
}

void GridMirror::remove(messaging::Handle instance) {
  const auto key = keys_.find(instance);
  if (key == keys_.end()) return;
  tiles_.erase(key->second);
  keys_.erase(key);
}

bool GridMirror::whole() const {
  for (std::uint32_t number = 0; number < summary_->tile_versions().size(); ++number) {
    const auto tile = tiles_.find(number);
    if (tile == tiles_.end() || tile->second.version != summary_->tile_versions()[number]) {
      return false;
    }
  }
  return true;
}

std::optional<GridMirror::Change> GridMirror::take() {
  if (!summary_ || (map_ && map_->version() == summary_->version() && same_frame(*map_, *summary_)))
    return std::nullopt;
  if (!whole()) return std::nullopt;
  Change change;
  change.whole = !map_ || !same_frame(*map_, *summary_);
  const std::uint32_t across = tiles_across(summary_->columns());
  std::uint32_t low_column = across;
  std::uint32_t low_row = tiles_across(summary_->rows());
  std::uint32_t high_column = 0;
  std::uint32_t high_row = 0;
  if (change.whole) {
    cells_.assign(static_cast<std::size_t>(summary_->columns()) * summary_->rows(),
                  ros::kUnknownCell);
  }
  for (std::uint32_t number = 0; number < summary_->tile_versions().size(); ++number) {
    if (!change.whole && map_->tile_versions()[number] == summary_->tile_versions()[number])
      continue;
    low_column = std::min(low_column, number % across);
    high_column = std::max(high_column, number % across + 1);
    low_row = std::min(low_row, number / across);
    high_row = std::max(high_row, number / across + 1);
  }
  map_ = summary_;
  for (std::uint32_t row = low_row; row < high_row; ++row) {
    for (std::uint32_t column = low_column; column < high_column; ++column) {
      const std::uint32_t number = row * across + column;
      copy(tiles_.at(number), number);
    }
  }
  if (low_row >= high_row) return std::nullopt;  // only places or rules have changed
  change.column = static_cast<std::int32_t>(low_column * kSide);
  change.row = static_cast<std::int32_t>(low_row * kSide);
  change.columns = std::min(high_column * kSide, map_->columns()) - low_column * kSide;
  change.rows = std::min(high_row * kSide, map_->rows()) - low_row * kSide;
  return change;
}

void GridMirror::copy(const Tile& tile, std::uint32_t number) {
  const std::uint32_t across = tiles_across(map_->columns());
  const std::uint32_t first_column = number % across * kSide;
  const std::uint32_t first_row = number / across * kSide;
  const std::uint32_t columns = std::min(kSide, map_->columns() - first_column);
  const std::uint32_t rows = std::min(kSide, map_->rows() - first_row);
  for (std::uint32_t row = 0; row < rows; ++row) {
    const auto* from = tile.cells.data() + static_cast<std::size_t>(row) * kSide;
    std::copy_n(
        from, columns,
        cells_.data() + static_cast<std::size_t>(first_row + row) * map_->columns() + first_column);
  }
}

ros::OccupancyGrid GridMirror::grid(const std::string& frame, std::int64_t stamp_ns) const {
  return ros::occupancy_grid(
      {map_->columns(), map_->rows(), map_->resolution_m(), origin_of(*map_)}, cells_,
      ros::header_of(frame, stamp_ns));
}

ros::OccupancyGridUpdate GridMirror::update(const Change& change, const std::string& frame,
                                            std::int64_t stamp_ns) const {
  ros::OccupancyGridUpdate update;
  update.header_(ros::header_of(frame, stamp_ns));
  update.x_(change.column);
  update.y_(change.row);
  update.width_(change.columns);
  update.height_(change.rows);
  update.data_().reserve(static_cast<std::size_t>(change.columns) * change.rows);
  for (std::uint32_t row = 0; row < change.rows; ++row) {
    const auto* from = cells_.data() +
                       (static_cast<std::size_t>(change.row) + row) * map_->columns() +
                       static_cast<std::size_t>(change.column);
    update.data_().insert(update.data_().end(), from, from + change.columns);
  }
  return update;
}

std::vector<std::optional<msg::Point2>> GridMirror::zone_middles() const {
  struct Sum {
    double column = 0.0;
    double row = 0.0;
    double cells = 0.0;
    double best = -1.0;  // squared distance from the middle
    double best_column = 0.0;
    double best_row = 0.0;
  };
  std::vector<Sum> sums(map_->zones().size());
  const std::uint32_t across = tiles_across(map_->columns());
  const auto for_each_cell = [&](const auto& visit) {
    for (const auto& [number, tile] : tiles_) {
      for (std::uint32_t i = 0; i < msg::kTileArea; ++i) {
        if (tile.zones[i] >= sums.size()) continue;
        const std::uint32_t column = number % across * kSide + i % kSide;
        const std::uint32_t row = number / across * kSide + i / kSide;
        visit(sums[tile.zones[i]], column + 0.5, row + 0.5);
      }
    }
  };
  for_each_cell([](Sum& sum, double column, double row) {
    sum.column += column;
    sum.row += row;
    sum.cells += 1.0;
  });
  for_each_cell([](Sum& sum, double column, double row) {
    const double away = std::hypot(column - sum.column / sum.cells, row - sum.row / sum.cells);
    if (sum.best >= 0.0 && away >= sum.best) return;
    sum.best = away;
    sum.best_column = column;
    sum.best_row = row;
  });
  std::vector<std::optional<msg::Point2>> middles;
  for (const Sum& sum : sums) {
    if (sum.best < 0.0) {
      middles.emplace_back();
      continue;
    }
    const Eigen::Vector2d at_m =
        origin_of(*map_) * Eigen::Vector2d(sum.best_column * map_->resolution_m(),
                                           sum.best_row * map_->resolution_m());
    msg::Point2 point;
    point.x_m(at_m.x());
    point.y_m(at_m.y());
    middles.emplace_back(point);
  }
  return middles;
}

}  // namespace topogeo::ros_bridge
