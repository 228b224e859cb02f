#include "topogeo/exchange/grid_map.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/support/check_range.hpp"
#include "topogeo/support/foreign_file.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

#include "grid_links.hpp"

namespace topogeo::exchange {
namespace {

using planning::Cell;
using planning::CellState;

constexpr int kBeams = 720;  // all around in steps of half a degree, like most logs
constexpr std::int64_t kBetweenStops_ns = 1'000'000'000;
// Standard deviation of the poses, which are exact in the grid: a tenth of a usual cell.
constexpr double kSigma_m = 0.01;
constexpr double kSigma_rad = 0.002;

/// Cells of parts of the free space that are large enough, widest first.
std::vector<std::size_t> cells_by_width(const planning::FreeSpace& space, double least_area_m2) {
  const planning::GridFrame& frame = space.frame();
  const double least_cells = least_area_m2 / (frame.resolution_m * frame.resolution_m);
  std::vector<std::uint8_t> seen(frame.size(), 0);
  std::vector<std::size_t> cells;
  std::vector<std::size_t> part;
  for (std::size_t first = 0; first < frame.size(); ++first) {
    if (seen[first] != 0 || !space.passable(first)) continue;
    part.assign(1, first);
    seen[first] = 1;
    for (std::size_t next = 0; next < part.size(); ++next) {
      const Cell cell = frame.cell_at(part[next]);
      for (const Cell& beside :
           {Cell{cell.column + 1, cell.row}, Cell{cell.column - 1, cell.row},
            Cell{cell.column, cell.row + 1}, Cell{cell.column, cell.row - 1}}) {
        if (!space.passable(beside)) continue;
        const std::size_t index = frame.index(beside);
        if (seen[index] != 0) continue;
        seen[index] = 1;
        part.push_back(index);
      }
    }
    if (static_cast<double>(part.size()) >= least_cells) {
      cells.insert(cells.end(), part.begin(), part.end());
    }
  }
  // Width and number of a cell as one number, because sorting large grids by two keys takes
  // seconds.
  constexpr unsigned kNumberBits = 32;
  constexpr auto kWidest = std::uint64_t{std::numeric_limits<std::int32_t>::max()};
  for (std::size_t& cell : cells) {
    const auto wide = static_cast<std::uint64_t>(space.squared_cells(cell));
    cell |= (kWidest - wide) << kNumberBits;
  }
  std::ranges::sort(cells);
  for (std::size_t& cell : cells) cell &= std::numeric_limits<std::uint32_t>::max();
  return cells;
}

/// Middles of cells, each at least `spacing_m` from the earlier ones; stops at one more than
/// `most`.
std::vector<Eigen::Vector2d> places_apart(const planning::GridFrame& frame,
                                          const std::vector<std::size_t>& cells, double spacing_m,
                                          std::size_t most) {
  const double spacing_cells = spacing_m / frame.resolution_m;
  const auto reach = static_cast<std::int32_t>(std::ceil(spacing_cells));
  std::vector<std::uint8_t> taken(frame.size(), 0);
  std::vector<Eigen::Vector2d> places;
  for (const std::size_t index : cells) {
    if (taken[index] != 0) continue;
    const Cell at = frame.cell_at(index);
    places.push_back(frame.center_m(at));
    if (places.size() > most) break;
    const std::int32_t last_row = std::min(at.row + reach, frame.rows - 1);
    const std::int32_t last_column = std::min(at.column + reach, frame.columns - 1);
    for (std::int32_t row = std::max(at.row - reach, 0); row <= last_row; ++row) {
      for (std::int32_t column = std::max(at.column - reach, 0); column <= last_column; ++column) {
        const double rows = row - at.row;
        const double columns = column - at.column;
        if (rows * rows + columns * columns < spacing_cells * spacing_cells) {
          taken[frame.index({column, row})] = 1;
        }
      }
    }
  }
  return places;
}

/// The widest places, each far enough from the earlier ones.
std::vector<Eigen::Vector2d> places_of_stops(const planning::FreeSpace& space,
                                             const GridMapSettings& settings) {
  const planning::GridFrame& frame = space.frame();
  const std::vector<std::size_t> cells = cells_by_width(space, settings.least_area_m2);
  const double steps = settings.range_m / frame.resolution_m;
  const std::size_t most =
      std::min(kMostGridStops, static_cast<std::size_t>(std::max(kMostGridSteps / steps, 1.0)));
  for (double spacing_m = settings.spacing_m;; spacing_m *= 2.0) {
    std::vector<Eigen::Vector2d> places = places_apart(frame, cells, spacing_m, most);
    if (places.size() <= most) return places;
    if (settings.fixed_spacing) {
      throw std::runtime_error(fmt::format(
          "the grid has room for more than {} stops that are {:g} m apart and see {:g} m: expected "
          "a larger spacing",
          most, settings.spacing_m, settings.range_m));
    }
  }
}

scan::Scan scan_at(const planning::OccupancyGrid& grid, const geometry::Pose2& T_map_laser,
                   double range_m) {
  scan::Scan scan;
  scan.angle_step_rad = 2.0 * std::numbers::pi / kBeams;
  scan.angle_min_rad = -std::numbers::pi + 0.5 * scan.angle_step_rad;
  for (int i = 0; i < kBeams; ++i) {
    const double angle_rad = scan.angle_min_rad + i * scan.angle_step_rad;
    scan.ranges_m.push_back(
        cast_beam(grid, T_map_laser.position_m(), T_map_laser.theta_rad + angle_rad, range_m));
  }
  return scan;
}

/// The borders of cells that a beam crosses in one direction of the grid, all in cells.
struct CellBorders {
  CellBorders(double from, double direction)
      : first(static_cast<std::int32_t>(std::floor(from))), step(direction > 0.0 ? 1 : -1) {
    constexpr double kParallel = 1e-12;
    if (!(std::fabs(direction) > kParallel)) return;
    next = (first + (direction > 0.0 ? 1.0 : 0.0) - from) / direction;
    width = 1.0 / std::fabs(direction);
  }

  std::int32_t first;  // cell
  std::int32_t step;
  double next = std::numeric_limits<double>::infinity();   // along the beam, to the next border
  double width = std::numeric_limits<double>::infinity();  // distance between two borders
};

std::uint64_t session_of_grid(const planning::OccupancyGrid& grid, const std::string& robot_id) {
  support::Fnv1a hash;
  hash.add(robot_id);
  for (const CellState state : grid.cells()) hash.add(static_cast<std::uint64_t>(state));
  return std::max<std::uint64_t>(hash.value(), 1);
}

}  // namespace

float cast_beam(const planning::OccupancyGrid& grid, const Eigen::Vector2d& from_m,
                double heading_rad, double range_m) {
  // Steps from cell to cell along the beam (Amanatides and Woo, "A fast voxel traversal algorithm
  // for ray tracing", 1987), all in cells.
  const planning::GridFrame& frame = grid.frame();
  const Eigen::Vector2d from = frame.in_cells(from_m);
  const auto [sin, cos] = geometry::sincos(heading_rad - frame.T_map_grid.theta_rad);
  // Borders of one direction each. Separate variables stay in registers, which is five times as
  // fast as arrays, and most of an import's time is spent here.
  CellBorders columns(from.x(), cos);
  CellBorders rows(from.y(), sin);
  Cell here{columns.first, rows.first};
  const double most = range_m / frame.resolution_m;
  const std::span<const CellState> cells = grid.cells();
  for (double along = 0.0; along < most;) {
    if (!frame.contains(here)) break;
    const CellState state = cells[frame.index(here)];
    if (state == CellState::kUnknown) break;
    if (state == CellState::kOccupied) {
      const double to_middle =
          (here.column + 0.5 - from.x()) * cos + (here.row + 0.5 - from.y()) * sin;
      return static_cast<float>(std::max(to_middle, 0.01) * frame.resolution_m);
    }
    if (columns.next < rows.next) {
      along = columns.next;
      columns.next += columns.width;
      here.column += columns.step;
    } else {
      along = rows.next;
      rows.next += rows.width;
      here.row += rows.step;
    }
  }
  return scan::Scan::kNoReturn;
}

void check_grid_size(const planning::GridFrame& frame) {
  if (frame.size() <= support::kMostPixels) return;
  throw std::runtime_error(fmt::format("a grid of {} x {} cells, expected at most {} in all",
                                       frame.columns, frame.rows, support::kMostPixels));
}

storage::MapDocument map_of_grid(const planning::FreeSpace& space,
                                 const pipeline::LocalMapperConfig& mapper,
                                 const topomap::GlobalMapConfig& global_map,
                                 const std::string& robot_id, const GridMapSettings& settings) {
  support::check_range("spacing of stops", settings.spacing_m, 0.2, 100.0, "m");
  support::check_range("range of the laser", settings.range_m, 1.0, 100.0, "m");
  storage::MapDocument document;
  document.robot_id = robot_id;
  document.drawing.grid = space.grid();
  const std::uint64_t session = session_of_grid(space.grid(), robot_id);
  voronoi::LocalVoronoi diagram_maker(mapper.voronoi);
  voronoi::LocalVoronoiDiagram diagram;
  topomap::LocalMapBuilder builder(mapper.local_map);
  const std::vector<Eigen::Vector2d> places_m = places_of_stops(space, settings);
  const std::size_t work = places_m.size() + 1;  // the stops and the graph
  const auto report = [&](std::size_t done) {
    if (settings.progress) settings.progress(done, work);
  };
  for (const Eigen::Vector2d& place_m : places_m) {
    const geometry::Pose2 T_map_robot{place_m.x(), place_m.y(), 0.0};
    scan::Scan scan = scan_at(space.grid(), T_map_robot * mapper.T_robot_laser, settings.range_m);
    topomap::LocalMap map;
    map.robot_id = robot_id;
    map.id = static_cast<std::uint32_t>(document.local_maps.size());
    map.stop = {session, map.id};
    map.sequence = scan.sequence = map.id;
    map.stamp_ns = scan.stamp_ns = kBetweenStops_ns * (map.id + 1);
    map.T_odom_robot = scan.T_odom_robot = T_map_robot;
    map.starts_drive = map.id > 0;  // nothing was driven
    diagram_maker.compute(scan, diagram);
    builder.build(diagram, scan, mapper.T_robot_laser, map);
    topomap::StopPose stop;
    stop.local_map_id = map.id;
    stop.stamp_ns = map.stamp_ns;
    stop.stop = map.stop;
    stop.T_map_robot = T_map_robot;
    stop.covariance =
        Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
            .asDiagonal();
    document.trajectory.stops.push_back(stop);
    document.local_maps.push_back(std::move(map));
    report(document.local_maps.size());
  }
  document.trajectory.version = 1;
  if (document.local_maps.empty()) return document;
  document.global_map = pipeline::fuse(global_map, document.local_maps, document.trajectory);
  link_parts(document.global_map, space, places_m);
  report(work);
  return storage::identified(std::move(document));
}

}  // namespace topogeo::exchange
