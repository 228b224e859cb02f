#include "topogeo/planning/room_numbers.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

#include "seen_rooms.hpp"

namespace topogeo::planning {
namespace {

ZoneId zone_at(const GridFrame& frame, const ZoneMap& zones, const Eigen::Vector2d& point_m) {
  const auto cell = frame.cell_of(point_m);
  return cell ? zones.zone_of_cell[frame.index(*cell)] : kNoZone;
}

}  // namespace

void RoomNumbers::assign(const FreeSpace& space, std::span<const topomap::StopPose> stops,
                         ZoneMap& zones, std::vector<Place>& places) {
  const GridFrame& frame = space.frame();
  const StopPoses poses = poses_of(stops);
  find_again(frame, poses, zones);
  give_new_numbers(space, poses, places, zones);
  keep_places(frame, poses, zones, places);
  name(frame, places, zones);
  remember(frame, poses, zones);
}

void RoomNumbers::give_new_numbers(const FreeSpace& space, const StopPoses& poses,
                                   const std::vector<Place>& places, ZoneMap& zones) {
  std::vector<bool> wanted(zones.zones.size(), true);
  if (!poses.empty()) wanted = zones_seen_well(space, poses, zones);
  for (const Place& place : places) {
    const ZoneId zone = zone_at(space.frame(), zones, place.position_m);
    if (zone != kNoZone) wanted[zone] = true;
  }
  for (Zone& zone : zones.zones) {
    const bool drawn = !zone.name.empty();
    if (zone.room == 0 && (drawn || wanted[zone.id])) zone.room = ++memory_.last;
  }
}

RoomPoint RoomNumbers::point_at(const Eigen::Vector2d& position_m, const StopPoses& poses) {
  RoomPoint point{std::nullopt, position_m};
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& [key, T_map_stop] : poses) {
    const double away_m = (T_map_stop.position_m() - position_m).norm();
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    point = {key, inverse(T_map_stop) * position_m};
  }
  return point;
}

void RoomNumbers::find_again(const GridFrame& frame, const StopPoses& poses, ZoneMap& zones) const {
  // Shared floor in cells, room, zone.
  std::vector<std::tuple<double, const RememberedRoom*, ZoneId>> common;
  const auto compare = [&](const RememberedRoom& room) {
    std::map<ZoneId, std::size_t> votes;
    for (const RoomPoint& point : room.points) {
      const auto at_m = position_of(point, poses);
      if (at_m) ++votes[zone_at(frame, zones, *at_m)];
    }
    for (const auto& [zone, count] : votes) {
      if (zone == kNoZone) continue;
      const double share = static_cast<double>(count) / static_cast<double>(room.points.size());
      common.emplace_back(share * static_cast<double>(room.cells), &room, zone);
    }
  };
  std::ranges::for_each(memory_.rooms, compare);
  std::ranges::for_each(gone_, compare);
  std::stable_sort(common.begin(), common.end(),
                   [](const auto& a, const auto& b) { return std::get<0>(a) > std::get<0>(b); });
  constexpr double kSame = 0.5;  // of the smaller of the two
  std::vector<const RememberedRoom*> taken;
  for (const auto& [cells, room, id] : common) {
    Zone& zone = zones.zones[id];
    if (zone.room != 0 || std::find(taken.begin(), taken.end(), room) != taken.end()) continue;
    if (cells < kSame * static_cast<double>(std::min(room->cells, zone.cells))) continue;
    zone.room = room->number;
    if (zone.name.empty()) zone.name = room->name;
    taken.push_back(room);
  }
}

void RoomNumbers::keep_places(const GridFrame& frame, const StopPoses& poses, const ZoneMap& zones,
                              std::vector<Place>& places) {
  std::erase_if(memory_.places, [&](const RememberedPlace& kept) {
    return std::find(places.begin(), places.end(), kept.drawn) == places.end();
  });
  for (Place& place : places) {
    const auto kept = std::find_if(memory_.places.begin(), memory_.places.end(),
                                   [&](const RememberedPlace& k) { return k.drawn == place; });
    const auto room_at = [&](const Eigen::Vector2d& at_m) {
      const ZoneId zone = zone_at(frame, zones, at_m);
      return zone == kNoZone ? 0 : zones.zones[zone].room;
    };
    const std::uint32_t room = room_at(place.position_m);
    if (kept == memory_.places.end()) {
      const RoomPoint point = point_at(place.position_m, poses);
      const double heading_rad = point.stop ? poses.at(*point.stop).theta_rad : 0.0;
      if (room != 0) memory_.places.push_back({place, room, point, heading_rad});
      continue;
    }
    if (room == kept->room) continue;
    const auto moved_m = position_of(kept->point, poses);
    if (!moved_m || room_at(*moved_m) != kept->room) continue;
    place.position_m = *moved_m;
    if (place.station_heading_rad && kept->point.stop) {
      const double turned_rad = poses.at(*kept->point.stop).theta_rad - kept->stop_heading_rad;
      place.station_heading_rad = geometry::wrap_angle(*place.station_heading_rad + turned_rad);
    }
  }
}

void RoomNumbers::name(const GridFrame& frame, const std::vector<Place>& places,
                       ZoneMap& zones) const {
  std::map<ZoneId, std::vector<const Place*>> inside;
  for (const Place& place : places) {
    inside[zone_at(frame, zones, place.position_m)].push_back(&place);
  }
  for (Zone& zone : zones.zones) {
    const auto found = inside.find(zone.id);
    if (!zone.name.empty() || zone.room == 0) continue;
    const bool named = found != inside.end() && found->second.size() == 1;
    zone.name = named ? found->second.front()->name : room_name(zone.room);
  }
}

void RoomNumbers::keep_gone(const StopPoses& poses, std::span<const RememberedRoom> anew) {
  std::ranges::move(memory_.rooms, std::back_inserter(gone_));
  memory_.rooms.clear();
  std::erase_if(gone_, [&](const RememberedRoom& room) {
    const auto is_same = [&](const RememberedRoom& other) { return other.number == room.number; };
    const auto is_located = [&](const RoomPoint& point) {
      return position_of(point, poses).has_value();
    };
    return std::ranges::any_of(anew, is_same) || std::ranges::none_of(room.points, is_located);
  });
}

void RoomNumbers::remember(const GridFrame& frame, const StopPoses& poses, const ZoneMap& zones) {
  constexpr std::size_t kPoints = 64;  // gives shares an accuracy of some per cent
  std::vector<RememberedRoom> rooms;   // by zone
  for (const Zone& zone : zones.zones) {
    const bool named = zone.name != room_name(zone.room);
    rooms.push_back({zone.room, zone.cells, {}, named ? zone.name : ""});
  }
  std::vector<std::size_t> seen(zones.zones.size(), 0);
  for (std::size_t i = 0; i < zones.zone_of_cell.size(); ++i) {
    const ZoneId zone = zones.zone_of_cell[i];
    if (zone == kNoZone) continue;
    // Evenly spread over its cells.
    const std::size_t cells = zones.zones[zone].cells;
    const std::size_t wanted = std::min(kPoints, cells);
    const std::size_t before = seen[zone] * wanted / cells;
    ++seen[zone];
    if (seen[zone] * wanted / cells == before) continue;
    if (rooms[zone].number == 0) continue;
    rooms[zone].points.push_back(point_at(frame.center_m(frame.cell_at(i)), poses));
  }
  std::erase_if(rooms, [](const RememberedRoom& room) { return room.number == 0; });
  keep_gone(poses, rooms);
  memory_.rooms = std::move(rooms);
  std::sort(memory_.rooms.begin(), memory_.rooms.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
}

}  // namespace topogeo::planning
