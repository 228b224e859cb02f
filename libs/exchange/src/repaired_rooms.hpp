// Room numbers of a damaged map.
#pragma once

#include <string>

#include "topogeo/exchange/repair.hpp"
#include "topogeo/planning/room_memory.hpp"

namespace topogeo::exchange {

/// Readable rooms and the places in them; notes unreadable ones in `lost`. If the last assigned
/// number is lost, the largest one replaces it, so that no room gets another's number.
planning::RoomMemory repaired_rooms(const StoredPieces& pieces, const std::string& robot_id,
                                    Notes& lost);

}  // namespace topogeo::exchange
