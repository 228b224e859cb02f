// A map made of a grid alone: what a robot would have seen of it (docs/exchange.md, "Grid").
//
// Stops are put where the free space is widest, no two nearer than `spacing_m`, so they follow the
// middle of corridors. The scans, all around, are cast in the grid and go through the same steps as
// those of a robot, so that the map has nodes and branches, can be localized in and can be aligned
// with others.
#pragma once

#include <string>

#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/planning/free_space.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/topomap/global_map_config.hpp"

namespace topogeo::exchange {

struct GridMapSettings {
  double spacing_m = 1.5;  ///< between stops, [0.2, 100]
  double range_m = 20.0;   ///< of the laser, [1, 100]
  /// Parts of the free space below are left out: cells behind walls that scans saw by chance, m^2.
  double least_area_m2 = 2.0;
  /// Where the floor has room for too many stops it is refused; else they are put farther apart.
  bool fixed_spacing = false;
};

/// Stops of a map made of a grid, at most: a stop takes about 2 ms.
inline constexpr std::size_t kMostGridStops = 3000;
/// Cells along a beam times stops, at most: with the usual range and cells of 5 cm as many as
/// kMostGridStops need.
inline constexpr double kMostGridSteps = 1'200'000;

/// Throws std::runtime_error for a grid of more cells than a picture may have pixels: a drawn floor
/// can be of any size, and each cell takes work.
void check_grid_size(const planning::GridFrame& frame);

/// The document has the grid as its drawing. Empty but for that when no part of the free space is
/// large enough. Throws std::invalid_argument for settings out of range, and std::runtime_error for
/// a grid that needs more stops, or more steps of their beams.
storage::MapDocument map_of_grid(const planning::FreeSpace& space,
                                 const pipeline::LocalMapperConfig& mapper,
                                 const topomap::GlobalMapConfig& global_map,
                                 const std::string& robot_id, const GridMapSettings& settings = {});

/// Range of a beam from a point of the map frame: to the middle of the first occupied cell, as far
/// along the beam; scan::Scan::kNoReturn where there is none within `range_m` or before what is
/// unknown.
float cast_beam(const planning::OccupancyGrid& grid, const Eigen::Vector2d& from_m,
                double heading_rad, double range_m);

}  // namespace topogeo::exchange
