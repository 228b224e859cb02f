// Drawings between messages and storage.
#pragma once

#include "topogeo/msg/drawing.h"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::service {

/// Converts places, zones and lines; not the grid. Throws std::invalid_argument naming the list
/// when it has more entries than the message holds, or a name that is too long.
msg::DrawingContent to_msg(const storage::MapDrawing& drawing);

/// A drawing of version 0. Throws std::invalid_argument like check_drawing, and for unknown kinds.
storage::MapDrawing from_msg(const msg::DrawingContent& content);

/// storage::check, plus the limits of a live map and its robots: speeds of 0.01 to 10 m/s, headings
/// of -pi to pi, as many zones, lines and points as the messages hold. Throws std::invalid_argument
/// naming list, index and name of the entry.
void check_drawing(const storage::MapDrawing& drawing);

/// Removes the walls and openings of a floor that has become a grid. Doors stay, because rooms meet
/// there.
void drop_grid_lines(storage::MapDrawing& drawing);

/// Checks that the zones that are no rooms, and all lines, fit into the rules of the hybrid map.
/// Throws std::invalid_argument with their number and the limit.
void check_rules(const storage::MapDrawing& drawing);

}  // namespace topogeo::service
