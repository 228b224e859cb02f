// Makes a map from a grid alone, by simulating a robot in it (docs/exchange.md, "Grid").
//
// Places stops where the free space is widest, at least `spacing_m` apart, so they follow the
// middle of corridors. All-round scans are cast in the grid and processed like a robot's, so that
// the map has nodes and branches, allows localization and can be aligned with others. Where the
// scans leave the graph in parts, branches along the free space join them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::exchange {

struct GridMapSettings {
  double spacing_m = 1.5;  ///< between stops, [0.2, 100]
  double range_m = 20.0;   ///< of the laser, [1, 100]
  /// Smaller parts of the free space are left out: cells behind walls that scans saw by chance,
  /// m^2.
  double least_area_m2 = 2.0;
  /// If the floor has room for too many stops: true refuses it, false places them farther apart.
  bool fixed_spacing = false;
  /// Called after each stop and a last time when the graph is made, with the work that is done and
  /// all of it: large grids take seconds. May be empty.
  std::function<void(std::size_t done, std::size_t total)> progress{};
};

/// Most stops of a map made of a grid: a stop takes about 2 ms.
inline constexpr std::size_t kMostGridStops = 3000;
/// Most cells along a beam times stops: enough for kMostGridStops with the usual range and cells of
/// 5 cm.
inline constexpr double kMostGridSteps = 1'200'000;

/// Throws std::runtime_error if the grid has more cells than a picture may have pixels: a drawn
/// floor can have any size, and each cell takes work.
void check_grid_size(const planning::GridFrame& frame);

/// Makes a map with the grid as its drawing, otherwise empty if no part of the free space is large
/// enough. Throws std::invalid_argument for settings out of range, and std::runtime_error for a
/// grid that needs too many stops or beam steps.
storage::MapDocument map_of_grid(const planning::FreeSpace& space,
                                 const pipeline::LocalMapperConfig& mapper,
                                 const topomap::GlobalMapConfig& global_map,
                                 const std::string& robot_id, const GridMapSettings& settings = {});

/// Number of parts of a graph that no branch joins; virtual branches do not count.
std::size_t parts_of_graph(const topomap::GlobalMap& map);

/// Range of a beam from a point of the map frame to the middle of the first occupied cell,
/// projected onto the beam; scan::Scan::kNoReturn if there is none within `range_m` or an unknown
/// cell comes first.
float cast_beam(const planning::OccupancyGrid& grid, const Eigen::Vector2d& from_m,
                double heading_rad, double range_m);

}  // namespace topogeo::exchange
