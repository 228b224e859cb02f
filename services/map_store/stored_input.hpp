// What a map store that starts goes on with.
#pragma once

#include <optional>

#include "topogeo/planning/room_memory.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "map_input.hpp"

namespace topogeo::map_store {

/// The map that is there. `drawing` becomes what is drawn now, laid over the drawing of the map
/// unless people have drawn on that since;
/// `shown` its global map, if it has one; `rooms` what is remembered of its rooms. Throws like
/// MapDatabase::load.
MapInput::Stored stored_input(const storage::MapDatabase& database, storage::MapDrawing& drawing,
                              std::optional<topomap::GlobalMap>& shown,
                              planning::RoomMemory& rooms);

}  // namespace topogeo::map_store
