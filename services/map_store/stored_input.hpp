// Stored state with which a map store starts.
#pragma once

#include <optional>

#include "topogeo/planning/room_memory.hpp"
#include "topogeo/storage/map_database.hpp"
#include "topogeo/storage/map_drawing.hpp"
#include "topogeo/topomap/global_map.hpp"

#include "map_input.hpp"

namespace topogeo::map_store {

/// Returns the stored map. `drawing` is laid over the drawing of the map, unless people have drawn
/// on that since, and becomes the result; `shown` becomes the stored global map, if there is one;
/// `rooms` the remembered rooms. Throws like MapDatabase::load.
MapInput::Stored stored_input(const storage::MapDatabase& database, storage::MapDrawing& drawing,
                              std::optional<topomap::GlobalMap>& shown,
                              planning::RoomMemory& rooms);

}  // namespace topogeo::map_store
