#include "topogeo/planning/room_numbers.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <tuple>

namespace topogeo::planning {
namespace {

ZoneId zone_at(const GridFrame& frame, const ZoneMap& zones, const Eigen::Vector2d& point_m) {
  const auto cell = frame.cell_of(point_m);
  return cell ? zones.zone_of_cell[frame.index(*cell)] : kNoZone;
}

}  // namespace

void RoomNumbers::assign(const GridFrame& frame, std::span<const topomap::StopPose> stops,
                         ZoneMap& zones, std::vector<Place>& places) {
  const StopPoses poses = poses_of(stops);
  find_again(frame, poses, zones);
  for (Zone& zone : zones.zones) {
    if (zone.room == 0) zone.room = ++memory_.last;
  }
  keep_places(frame, poses, zones, places);
  name(frame, places, zones);
  remember(frame, poses, zones);
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
  for (const RememberedRoom& room : memory_.rooms) {
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
  }
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
    if (!zone.name.empty()) continue;
    const bool named = found != inside.end() && found->second.size() == 1;
    zone.name = named ? found->second.front()->name : room_name(zone.room);
  }
}

void RoomNumbers::remember(const GridFrame& frame, const StopPoses& poses, const ZoneMap& zones) {
  constexpr std::size_t kPoints = 64;  // gives shares an accuracy of some per cent
  memory_.rooms.clear();
  for (const Zone& zone : zones.zones) {
    const bool named = zone.name != room_name(zone.room);
    memory_.rooms.push_back({zone.room, zone.cells, {}, named ? zone.name : ""});
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
    memory_.rooms[zone].points.push_back(point_at(frame.center_m(frame.cell_at(i)), poses));
  }
  std::sort(memory_.rooms.begin(), memory_.rooms.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
}

}  // namespace topogeo::planning
