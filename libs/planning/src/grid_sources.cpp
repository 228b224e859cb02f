#include "topogeo/planning/grid_sources.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "cell_line.hpp"

namespace topogeo::planning {
namespace {

// The box around points, as the frame of a grid.
class Bounds {
 public:
  void add(const Eigen::Vector2d& point_m, double reach_m = 0.0) {
    if (!point_m.allFinite() || !std::isfinite(reach_m)) {
      throw std::invalid_argument("grid: a coordinate is not finite");
    }
    low_m_ = low_m_.cwiseMin(point_m - Eigen::Vector2d::Constant(reach_m));
    high_m_ = high_m_.cwiseMax(point_m + Eigen::Vector2d::Constant(reach_m));
  }

  [[nodiscard]] bool empty() const { return !(low_m_.x() <= high_m_.x()); }

  [[nodiscard]] GridFrame frame(double resolution_m, double margin_m,
                                std::int32_t snap_cells = 1) const {
    GridFrame probe;
    probe.columns = probe.rows = 1;
    probe.resolution_m = resolution_m;
    check(probe);
    GridFrame frame = probe;
    const double x_cells = snapped((low_m_.x() - margin_m) / resolution_m, snap_cells);
    const double y_cells = snapped((low_m_.y() - margin_m) / resolution_m, snap_cells);
    frame.T_map_grid = {x_cells * resolution_m, y_cells * resolution_m, 0.0};
    frame.columns = cells((high_m_.x() + margin_m) / resolution_m - x_cells);
    frame.rows = cells((high_m_.y() + margin_m) / resolution_m - y_cells);
    check(frame);
    return frame;
  }

  /// The drawn frame, extended by multiples of snap_cells until it contains the points, which are
  /// in its cells.
  [[nodiscard]] GridFrame grown(const GridFrame& drawn, std::int32_t snap_cells) const {
    const double left = std::min(snapped(low_m_.x(), snap_cells), 0.0);
    const double down = std::min(snapped(low_m_.y(), snap_cells), 0.0);
    GridFrame frame = drawn;
    frame.columns = cells(std::max(high_m_.x(), drawn.columns - 1.0) - left);
    frame.rows = cells(std::max(high_m_.y(), drawn.rows - 1.0) - down);
    if (left < 0.0 || down < 0.0) {
      frame.T_map_grid = drawn.T_map_grid *
                         geometry::Pose2{left * drawn.resolution_m, down * drawn.resolution_m, 0.0};
    }
    check(frame);
    return frame;
  }

 private:
  static double snapped(double cells, std::int32_t snap_cells) {
    return std::floor(cells / snap_cells) * snap_cells;
  }

  // Saturates: too many cells remain too many.
  static std::int32_t cells(double count) {
    constexpr double kTooMany = 1e9;
    return static_cast<std::int32_t>(std::min(std::floor(count) + 1.0, kTooMany));
  }

  Eigen::Vector2d low_m_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high_m_ = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());
};

void draw_line(OccupancyGrid& grid, const Drawing::Line& line) {
  const GridFrame& frame = grid.frame();
  visit_line(frame.in_cells(line.a_m), frame.in_cells(line.b_m), [&](const Cell& cell) {
    if (frame.contains(cell)) grid.set(cell, CellState::kOccupied);
    return true;
  });
}

// Every cell whose square is within the radius of the middle.
void draw_disc(OccupancyGrid& grid, const Drawing::Disc& disc) {
  const GridFrame& frame = grid.frame();
  const Eigen::Vector2d middle = frame.in_cells(disc.center_m);
  const double radius = disc.radius_m / frame.resolution_m;
  const auto reach = static_cast<std::int32_t>(radius) + 1;
  const Cell at{static_cast<std::int32_t>(std::floor(middle.x())),
                static_cast<std::int32_t>(std::floor(middle.y()))};
  for (std::int32_t row = at.row - reach; row <= at.row + reach; ++row) {
    for (std::int32_t column = at.column - reach; column <= at.column + reach; ++column) {
      const Eigen::Vector2d nearest(std::clamp(middle.x(), column + 0.0, column + 1.0),
                                    std::clamp(middle.y(), row + 0.0, row + 1.0));
      const Cell cell{column, row};
      if (frame.contains(cell) && (nearest - middle).norm() <= radius) {
        grid.set(cell, CellState::kOccupied);
      }
    }
  }
}

// Free space that no seed reaches becomes unknown.
void keep_reached(OccupancyGrid& grid, const std::vector<Eigen::Vector2d>& seeds_m) {
  const GridFrame& frame = grid.frame();
  std::vector<std::uint8_t> reached(frame.size(), 0);
  std::vector<Cell> open;
  const auto reach = [&](const Cell& cell) {
    if (!frame.contains(cell) || grid.at(cell) != CellState::kFree) return;
    if (reached[frame.index(cell)] != 0) return;
    reached[frame.index(cell)] = 1;
    open.push_back(cell);
  };
  for (const Eigen::Vector2d& seed_m : seeds_m) {
    if (const auto cell = frame.cell_of(seed_m)) reach(*cell);
  }
  while (!open.empty()) {
    const Cell cell = open.back();
    open.pop_back();
    reach({cell.column + 1, cell.row});
    reach({cell.column - 1, cell.row});
    reach({cell.column, cell.row + 1});
    reach({cell.column, cell.row - 1});
  }
  for (std::size_t i = 0; i < reached.size(); ++i) {
    const Cell cell = frame.cell_at(i);
    if (reached[i] == 0 && grid.at(cell) == CellState::kFree) grid.set(cell, CellState::kUnknown);
  }
}

// Log-odds of every cell, raised and lowered scan by scan.
class Evidence {
 public:
  Evidence(const GridFrame& frame, const ScanGridConfig& config)
      : frame_(frame), config_(config), odds_(frame.size(), 0), last_scan_(frame.size(), 0) {}

  // A cell counts once per scan, as a hit if any beam ends there.
  void add(const topomap::LocalMap& map, const geometry::Pose2& T_map_robot) {
    ++scan_;
    const Eigen::Vector2d from = frame_.in_cells((T_map_robot * map.T_robot_laser).position_m());
    ends_.clear();
    for (const topomap::ScanPoint& p : map.points) {
      ends_.push_back(frame_.in_cells(T_map_robot * Eigen::Vector2d(p.x_m, p.y_m)));
      count({static_cast<std::int32_t>(ends_.back().x()),
             static_cast<std::int32_t>(ends_.back().y())},
            config_.hit);
    }
    for (const Eigen::Vector2d& end : ends_) {
      visit_line(from, end, [this](const Cell& cell) {
        count(cell, -config_.miss);
        return true;
      });
    }
  }

  [[nodiscard]] OccupancyGrid grid() const {
    OccupancyGrid grid(frame_);
    for (std::size_t i = 0; i < odds_.size(); ++i) {
      if (odds_[i] == 0) continue;
      grid.set(frame_.cell_at(i), odds_[i] > 0 ? CellState::kOccupied : CellState::kFree);
    }
    return grid;
  }

 private:
  // Points on the edge of a grid without a margin lie outside of it.
  void count(const Cell& cell, std::int32_t change) {
    if (!frame_.contains(cell)) return;
    const std::size_t i = frame_.index(cell);
    if (last_scan_[i] == scan_) return;
    last_scan_[i] = scan_;
    odds_[i] = std::clamp(odds_[i] + change, -config_.limit, config_.limit);
  }

  GridFrame frame_;
  ScanGridConfig config_;
  std::vector<std::int32_t> odds_;
  std::vector<std::uint32_t> last_scan_;
  std::uint32_t scan_ = 0;
  std::vector<Eigen::Vector2d> ends_;
};

/// The part of a wall inside an opening, as fractions of its length; empty if none is.
std::pair<double, double> share_in(const Drawing::Line& wall, const DrawnLine& opening) {
  const Eigen::Vector2d& from_m = opening.points_m.front();
  const Eigen::Vector2d stretch_m = opening.points_m.back() - from_m;
  const Eigen::Vector2d along = stretch_m.normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  const Eigen::Vector2d way_m = wall.b_m - wall.a_m;
  double begin = 0.0;
  double end = 1.0;
  const auto clip = [&](const Eigen::Vector2d& axis, double low_m, double high_m) {
    const double at_m = (wall.a_m - from_m).dot(axis);
    const double step_m = way_m.dot(axis);
    if (step_m == 0.0) {
      if (at_m < low_m || at_m > high_m) end = begin;
      return;
    }
    const double one = (low_m - at_m) / step_m;
    const double other = (high_m - at_m) / step_m;
    begin = std::max(begin, std::min(one, other));
    end = std::min(end, std::max(one, other));
  };
  clip(along, 0.0, stretch_m.norm());
  clip(across, -kOpeningReach_m, kOpeningReach_m);
  return {begin, end};
}

void add_pieces(const Drawing::Line& wall, std::span<const DrawnLine> lines,
                std::vector<Drawing::Line>& pieces) {
  std::vector<std::pair<double, double>> gaps;
  for (const DrawnLine& line : lines) {
    if (line.kind == LineKind::kWall) continue;
    const auto gap = share_in(wall, line);
    if (gap.first < gap.second) gaps.push_back(gap);
  }
  std::sort(gaps.begin(), gaps.end());
  const auto at_m = [&](double share) -> Eigen::Vector2d {
    return wall.a_m + share * (wall.b_m - wall.a_m);
  };
  double done = 0.0;
  for (const auto& [begin, end] : gaps) {
    if (begin > done) pieces.push_back({at_m(done), at_m(begin)});
    done = std::max(done, end);
  }
  if (done < 1.0) pieces.push_back({at_m(done), wall.b_m});
}

void check_stops(std::span<const topomap::LocalMap> maps,
                 std::span<const topomap::StopPose> stops) {
  if (stops.size() <= maps.size()) return;
  throw std::invalid_argument("grid from scans: " + std::to_string(stops.size()) + " stops but " +
                              std::to_string(maps.size()) + " local maps");
}

// Adds lasers and scan points of the located stops, transformed by `place`.
template <typename Place>
void add_points(std::span<const topomap::LocalMap> maps, std::span<const topomap::StopPose> stops,
                const Place& place, Bounds& bounds) {
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (!stops[i].located || maps[i].points.empty()) continue;
    bounds.add(place((stops[i].T_map_robot * maps[i].T_robot_laser).position_m()));
    for (const topomap::ScanPoint& p : maps[i].points) {
      bounds.add(place(stops[i].T_map_robot * Eigen::Vector2d(p.x_m, p.y_m)));
    }
  }
}

// The cells that the scans saw, on a grid that contains all their points.
OccupancyGrid seen(const GridFrame& frame, std::span<const topomap::LocalMap> maps,
                   std::span<const topomap::StopPose> stops, const ScanGridConfig& config) {
  Evidence evidence(frame, config);
  for (std::size_t i = 0; i < stops.size(); ++i) {
    if (stops[i].located) evidence.add(maps[i], stops[i].T_map_robot);
  }
  return evidence.grid();
}

}  // namespace

OccupancyGrid grid_of(const Drawing& drawing, double resolution_m, double margin_m) {
  Bounds bounds;
  for (const Drawing::Line& line : drawing.lines) {
    bounds.add(line.a_m);
    bounds.add(line.b_m);
  }
  for (const Drawing::Disc& disc : drawing.discs) bounds.add(disc.center_m, disc.radius_m);
  if (bounds.empty()) throw std::invalid_argument("grid: the drawing is empty");
  OccupancyGrid grid(bounds.frame(resolution_m, margin_m), CellState::kFree);
  for (const Drawing::Line& line : drawing.lines) draw_line(grid, line);
  for (const Drawing::Disc& disc : drawing.discs) draw_disc(grid, disc);
  if (!drawing.inside_m.empty()) keep_reached(grid, drawing.inside_m);
  return grid;
}

std::vector<Drawing::Line> open_walls(std::span<const DrawnLine> lines) {
  std::vector<Drawing::Line> pieces;
  for (const DrawnLine& line : lines) {
    if (line.kind != LineKind::kWall) continue;
    for (std::size_t i = 0; i + 1 < line.points_m.size(); ++i) {
      add_pieces({line.points_m[i], line.points_m[i + 1]}, lines, pieces);
    }
  }
  return pieces;
}

OccupancyGrid grid_of_floor(std::span<const DrawnLine> lines, const Eigen::Vector2d& inside_m,
                            double resolution_m, double margin_m) {
  OccupancyGrid grid = grid_of({.lines = open_walls(lines)}, resolution_m, margin_m);
  const auto inside = grid.frame().cell_of(inside_m);
  if (!inside || grid.at(*inside) != CellState::kFree) {
    throw std::invalid_argument("floor: the point inside it is in a wall or outside");
  }
  keep_reached(grid, {inside_m});
  return grid;
}

OccupancyGrid grid_from_scans(std::span<const topomap::LocalMap> maps,
                              std::span<const topomap::StopPose> stops,
                              const ScanGridConfig& config) {
  check(config);
  check_stops(maps, stops);
  Bounds bounds;
  add_points(
      maps, stops, [](const Eigen::Vector2d& point_m) { return point_m; }, bounds);
  if (bounds.empty()) throw std::invalid_argument("grid from scans: no stop with scan points");
  return seen(bounds.frame(config.resolution_m, config.margin_m, config.snap_cells), maps, stops,
              config);
}

OccupancyGrid grid_of_both(const OccupancyGrid& drawn, std::span<const topomap::LocalMap> maps,
                           std::span<const topomap::StopPose> stops, const ScanGridConfig& config) {
  check(config);
  check_stops(maps, stops);
  Bounds bounds;
  add_points(
      maps, stops, [&](const Eigen::Vector2d& point_m) { return drawn.frame().in_cells(point_m); },
      bounds);
  if (bounds.empty()) return drawn;
  OccupancyGrid grid = seen(bounds.grown(drawn.frame(), config.snap_cells), maps, stops, config);
  // The drawing's first cell in the new grid.
  const Eigen::Vector2d shift = grid.frame().in_cells(drawn.frame().center_m({0, 0}));
  const Cell corner{static_cast<std::int32_t>(shift.x()), static_cast<std::int32_t>(shift.y())};
  for (std::size_t i = 0; i < drawn.cells().size(); ++i) {
    const CellState state = drawn.cells()[i];
    const Cell from = drawn.frame().cell_at(i);
    const Cell to{corner.column + from.column, corner.row + from.row};
    if (state == CellState::kOccupied || grid.at(to) == CellState::kUnknown) grid.set(to, state);
  }
  return grid;
}

}  // namespace topogeo::planning
