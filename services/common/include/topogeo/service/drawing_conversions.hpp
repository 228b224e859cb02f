// Drawings between messages and storage.
#pragma once

#include "topogeo/msg/drawing.h"
#include "topogeo/storage/map_drawing.hpp"

namespace topogeo::service {

/// Places, zones and lines; not the grid. Throws std::invalid_argument naming the list when it has
/// more entries than the message holds, or a name that is too long.
msg::DrawingContent to_msg(const storage::MapDrawing& drawing);

/// A drawing of version 0. Throws std::invalid_argument like check_drawing, and for what is of no
/// known kind.
storage::MapDrawing from_msg(const msg::DrawingContent& content);

/// storage::check, and what a live map has room for and robots can obey: speeds of 0.01 to 10 m/s,
/// headings of -pi to pi, as many zones and lines with as many points as the messages hold. Throws
/// std::invalid_argument naming list, index and name of the entry.
void check_drawing(const storage::MapDrawing& drawing);

/// Of a floor whose walls, openings and doors have become a grid: doors stay, because rooms meet
/// there.
void drop_grid_lines(storage::MapDrawing& drawing);

/// Whether all that lies over a map fits into the rules of its hybrid map: zones that are no rooms,
/// and all lines. Throws std::invalid_argument with their number and what is allowed.
void check_rules(const storage::MapDrawing& drawing);

}  // namespace topogeo::service
