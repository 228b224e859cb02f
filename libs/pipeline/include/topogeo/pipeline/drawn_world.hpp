// Worlds for the simulation, made from drawn floors.
#pragma once

#include <string>
#include <string_view>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::pipeline {

/// A world file (see world/world.hpp) with the walls of a drawing, open at its openings and doors,
/// and a robot at `T_floor_start`. Places and zones are not included. Throws std::invalid_argument
/// without a wall.
std::string drawn_world_text(std::string_view name, const storage::MapDrawing& drawing,
                             const geometry::Pose2& T_floor_start);

}  // namespace topogeo::pipeline
