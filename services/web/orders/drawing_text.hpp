// Drawings in the JSON of the protocol.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/storage/map_drawing.hpp"

#include "server/json_values.hpp"

namespace topogeo::web {

/// JSON of a drawing without its grid, including its version.
Json json_of(const storage::MapDrawing& drawing);

// All functions throw std::invalid_argument naming list, index, key and the expected value.

/// Parses a whole drawing; its version is the one that was edited.
storage::MapDrawing parse_drawing(const std::string& body);

struct ShapesOrder {
  std::vector<std::uint16_t> zones;                                  ///< at least one
  std::optional<std::pair<Eigen::Vector2d, Eigen::Vector2d>> cut_m;  ///< map frame
};
ShapesOrder parse_shapes_order(const std::string& body);

struct FloorText {
  bool simulator = false;  ///< otherwise the robot
  std::string name;
  geometry::Pose2 T_floor_start;
  storage::MapDrawing drawing;
};
FloorText parse_floor(const std::string& body);

}  // namespace topogeo::web
