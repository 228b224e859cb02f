#include "repaired_rooms.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "element_reader.hpp"
#include "map_fields.hpp"
#include "wire.hpp"

namespace topogeo::exchange {
namespace {

constexpr std::uint32_t kMostRooms = 1'000'000;  // a larger number is damaged

}  // namespace

planning::RoomMemory repaired_rooms(const StoredPieces& pieces, const std::string& robot_id,
                                    Notes& lost) {
  planning::RoomMemory rooms;
  const auto alone = [&](std::uint32_t field, const std::string& element) {
    return read_alone(robot_id, bytes_field(MapFields::kRooms,
                                            bytes_field(field, element) +
                                                varint_field(MapFields::kLastRoom, kMostRooms)))
        .rooms;
  };
  if (pieces.last_room <= kMostRooms) rooms.last = static_cast<std::uint32_t>(pieces.last_room);
  take_each(pieces.rooms, "rooms", lost, [&](const std::string& element) {
    planning::RememberedRoom room = alone(MapFields::kRoom, element).rooms.at(0);
    const auto at =
        std::ranges::lower_bound(rooms.rooms, room.number, {}, &planning::RememberedRoom::number);
    if (at != rooms.rooms.end() && at->number == room.number) {
      throw std::runtime_error("a duplicate number");
    }
    rooms.last = std::max(rooms.last, room.number);
    rooms.rooms.insert(at, std::move(room));
  });
  take_each(pieces.room_places, "places in rooms", lost, [&](const std::string& element) {
    rooms.places.push_back(alone(MapFields::kPlaceInRoom, element).places.at(0));
    rooms.last = std::max(rooms.last, rooms.places.back().room);
  });
  return rooms;
}

}  // namespace topogeo::exchange
