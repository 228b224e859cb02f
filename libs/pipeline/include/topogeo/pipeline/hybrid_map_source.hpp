// Makes the hybrid map of a floor from a drawing, from the robot's map, or from both (MACONDO,
// III.2; docs/algorithms.md, "Hybrid map and planner").
//
// The grid is the drawn one, the one from scans, or both combined by planning::grid_of_both. Zones
// are the drawn rooms and, outside of these, the rooms between walls and doors of the robot's map.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/hybrid_map_config.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/room_numbers.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::pipeline {

/// Input of a hybrid map, read only during the call. Missing parts are empty.
struct HybridMapParts {
  std::span<const topomap::LocalMap> local_maps;
  std::span<const topomap::StopPose> stops;
  const topomap::GlobalMap* global_map = nullptr;
  const storage::MapDrawing* drawing = nullptr;
  const planning::RoomMemory* rooms = nullptr;
};
HybridMapParts parts_of(const storage::MapDocument& document);

/// Whether there is a source for a grid: a drawing, or a located stop with scan points.
bool has_grid(const HybridMapParts& parts);

/// Throws std::invalid_argument with the reason if there is no source for a grid (no drawing and no
/// scan points), the grid would be too large, or the configuration is out of range. The lower left
/// corner of a grid from scans is a multiple of config.grid.snap_cells. Rooms have the numbers and
/// names that `rooms` remembers from earlier maps or, without it, those that the parts remember.
planning::HybridMap make_hybrid_map(const HybridMapParts& parts, const HybridMapConfig& config,
                                    planning::RoomNumbers* rooms = nullptr);

/// Numbers the rooms of a map by the memory of the document, and updates that memory. Does nothing
/// if no hybrid map can be made.
void remember_rooms(storage::MapDocument& document, const HybridMapConfig& config);

/// Moves a drawing from frame b to frame a; T is T_a_b.
void move(storage::MapDrawing& drawing, const geometry::Pose2& T);

/// A drawn floor: the grid and the places of a world file (.world.yaml, see world/world.hpp) with
/// cells of `resolution_m`, or the grid of a YAML file (see planning/grid_file.hpp). Adds the names
/// of `zones` (see planning::read_zone_drawing), in the frame of the drawing. Everything is moved
/// to the map frame. Throws std::runtime_error naming file, line or field.
storage::MapDrawing read_drawing(const std::filesystem::path& file,
                                 const std::optional<std::filesystem::path>& zones,
                                 double resolution_m, const geometry::Pose2& T_map_drawing = {});

/// Places and zones of a file, checked like a drawing, without a grid. Throws the same.
storage::MapDrawing read_zones_and_places(const std::filesystem::path& file);

/// Adds the content of `added` to `drawing`. Its grid replaces the existing one, and so do places
/// and zones with existing names. Other places and zones are appended, and so are new walls,
/// openings and doors.
void lay_over(storage::MapDrawing& drawing, storage::MapDrawing added);

/// The floor of one file: a world, a grid (both as read_drawing, with no robot) or a map file.
/// Throws std::runtime_error naming file, line or field.
storage::MapDocument read_floor(const std::filesystem::path& file,
                                const std::optional<std::filesystem::path>& zones,
                                double resolution_m);

}  // namespace topogeo::pipeline
