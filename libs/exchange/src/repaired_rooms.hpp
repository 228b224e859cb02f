// The numbers of rooms of a damaged map.
#pragma once

#include <string>

#include "topogeo/exchange/repair.hpp"
#include "topogeo/planning/room_memory.hpp"

namespace topogeo::exchange {

/// Rooms and the places in them that can be read; notes those that cannot in `lost`. Where the
/// number that was given last is lost it is the largest one, so that no room gets another's.
planning::RoomMemory repaired_rooms(const StoredPieces& pieces, const std::string& robot_id,
                                    Notes& lost);

}  // namespace topogeo::exchange
