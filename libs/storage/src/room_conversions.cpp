// Converts remembered rooms to and from Protobuf messages.
#include <algorithm>
#include <cmath>

#include "topogeo/support/format.hpp"

#include "map_conversions.hpp"

namespace topogeo::storage {
namespace {

template <typename... Args>
void require_rooms(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) throw std::runtime_error(fmt::format(format, std::forward<Args>(args)...));
}

void to_proto(const planning::RoomPoint& point, proto::RoomPoint* out) {
  out->set_of_stop(point.stop.has_value());
  out->set_session(point.stop ? point.stop->session : 0);
  out->set_number(point.stop ? point.stop->number : 0);
  out->set_x_m(point.position_m.x());
  out->set_y_m(point.position_m.y());
}

planning::RoomPoint from_proto(const proto::RoomPoint& in) {
  planning::RoomPoint point{std::nullopt, {in.x_m(), in.y_m()}};
  if (in.of_stop()) point.stop = topomap::StopId{in.session(), in.number()};
  return point;
}

bool is_finite(const planning::RoomPoint& point) {
  return point.position_m.allFinite();
}

}  // namespace

void to_proto(const planning::RememberedRoom& room, proto::Room* out) {
  out->set_number(room.number);
  out->set_cells(room.cells);
  out->set_name(room.name);
  for (const planning::RoomPoint& point : room.points) to_proto(point, out->add_points());
}

planning::RememberedRoom from_proto(const proto::Room& in) {
  planning::RememberedRoom room{in.number(), in.cells(), {}, in.name()};
  for (const proto::RoomPoint& point : in.points()) room.points.push_back(from_proto(point));
  return room;
}

void to_proto(const planning::RememberedPlace& place, proto::PlaceInRoom* out) {
  to_proto(place.drawn, out->mutable_drawn());
  out->set_room(place.room);
  to_proto(place.point, out->mutable_point());
  out->set_stop_heading_rad(place.stop_heading_rad);
}

planning::RememberedPlace from_proto(const proto::PlaceInRoom& in) {
  return {from_proto(in.drawn()), in.room(), from_proto(in.point()), in.stop_heading_rad()};
}

void to_proto(const planning::RoomMemory& rooms, proto::Rooms* out) {
  for (const auto& room : rooms.rooms) to_proto(room, out->add_rooms());
  for (const auto& place : rooms.places) to_proto(place, out->add_places());
  out->set_last(rooms.last);
}

planning::RoomMemory from_proto(const proto::Rooms& in) {
  planning::RoomMemory rooms;
  for (const proto::Room& room : in.rooms()) rooms.rooms.push_back(from_proto(room));
  for (const proto::PlaceInRoom& place : in.places()) rooms.places.push_back(from_proto(place));
  rooms.last = in.last();
  return rooms;
}

void check_rooms(const planning::RoomMemory& rooms) {
  std::uint32_t before = 0;
  for (const planning::RememberedRoom& room : rooms.rooms) {
    require_rooms(room.number > before && room.number <= rooms.last,
                  "room {} after {}: expected ascending numbers up to {}", room.number, before,
                  rooms.last);
    before = room.number;
    require_rooms(std::ranges::all_of(room.points, is_finite),
                  "room {} with a point that is not finite", room.number);
  }
  for (const planning::RememberedPlace& place : rooms.places) {
    require_rooms(place.room > 0 && place.room <= rooms.last,
                  "place '{}' in room {}: expected a number from 1 to {}", place.drawn.name,
                  place.room, rooms.last);
    require_rooms(is_finite(place.point) && std::isfinite(place.stop_heading_rad),
                  "place '{}' of a room with a point that is not finite", place.drawn.name);
  }
}

}  // namespace topogeo::storage
