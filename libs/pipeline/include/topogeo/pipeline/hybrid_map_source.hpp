// Makes the hybrid map of a floor from a drawing, from what the robot has mapped, or from both
// (MACONDO, III.2; docs/algorithms.md, "Hybrid map and planner").
//
// The grid is the drawn one, the one that scans saw, or the two as planning::grid_of_both lays them
// together. Zones are the drawn rooms and, outside of them, the rooms between the walls and the
// doors of the map that the robot has made.
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

/// What a hybrid map is made of, read during the call only. What is missing is empty.
struct HybridMapParts {
  std::span<const topomap::LocalMap> local_maps;
  std::span<const topomap::StopPose> stops;
  const topomap::GlobalMap* global_map = nullptr;
  const storage::MapDrawing* drawing = nullptr;
  const planning::RoomMemory* rooms = nullptr;
};
HybridMapParts parts_of(const storage::MapDocument& document);

/// Whether there is something to make a grid of: a drawn one, or a located stop that saw something.
bool has_grid(const HybridMapParts& parts);

/// Throws std::invalid_argument saying why when there is nothing to make a grid of (no drawing and
/// no scan points), the grid would be too large, or the configuration is out of range. The lower
/// left corner of a grid of scans lies at a multiple of config.grid.snap_cells. Rooms have the
/// numbers and names that `rooms` remembers from the maps before, without it those that the parts
/// remember.
planning::HybridMap make_hybrid_map(const HybridMapParts& parts, const HybridMapConfig& config,
                                    planning::RoomNumbers* rooms = nullptr);

/// Numbers the rooms of a map from what the document remembers of them, and makes it remember what
/// came of that. Nothing where no hybrid map can be made.
void remember_rooms(storage::MapDocument& document, const HybridMapConfig& config);

/// Takes a drawing of frame b to frame a; T is T_a_b.
void move(storage::MapDrawing& drawing, const geometry::Pose2& T);

/// A drawn floor: the grid and the places of a world file (.world.yaml, see world/world.hpp)
/// with cells of `resolution_m`, or the grid of a YAML file (see planning/grid_file.hpp). The names
/// of `zones` (see planning::read_zone_drawing), in the frame of the drawing, are added to it. All
/// is taken to the map frame. Throws std::runtime_error naming file, line or field.
storage::MapDrawing read_drawing(const std::filesystem::path& file,
                                 const std::optional<std::filesystem::path>& zones,
                                 double resolution_m, const geometry::Pose2& T_map_drawing = {});

/// Places and zones of a file, checked like a drawing; there is no grid. Throws the same.
storage::MapDrawing read_zones_and_places(const std::filesystem::path& file);

/// Puts what `added` has on `drawing`: its grid takes the place of the one there, and so do places
/// and zones of the same names; others come behind those there,
/// as do walls, openings and doors that are not there yet.
void lay_over(storage::MapDrawing& drawing, storage::MapDrawing added);

/// The floor of one file: a world, a grid (both as read_drawing, with no robot) or a map file.
/// Throws std::runtime_error naming file, line or field.
storage::MapDocument read_floor(const std::filesystem::path& file,
                                const std::optional<std::filesystem::path>& zones,
                                double resolution_m);

}  // namespace topogeo::pipeline
