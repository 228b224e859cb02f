#include "topogeo/planning/room_numbers.hpp"

#include <algorithm>
#include <limits>
#include <tuple>

namespace topogeo::planning {
namespace {

ZoneId zone_at(const GridFrame& frame, const ZoneMap& zones, const Eigen::Vector2d& point_m) {
  const auto cell = frame.cell_of(point_m);
  return cell ? zones.zone_of_cell[frame.index(*cell)] : kNoZone;
}

std::string name_of(std::uint32_t room) {
  return "room " + std::to_string(room);
}

}  // namespace

void RoomNumbers::assign(const GridFrame& frame, std::span<const topomap::StopPose> stops,
                         ZoneMap& zones, std::vector<Place>& places) {
  const Poses poses = poses_of(stops);
  find_again(frame, poses, zones);
  for (Zone& zone : zones.zones) {
    if (zone.room == 0) zone.room = ++last_;
  }
  keep_places(frame, poses, zones, places);
  name(frame, places, zones);
  remember(frame, poses, zones);
}

RoomNumbers::Poses RoomNumbers::poses_of(std::span<const topomap::StopPose> stops) {
  Poses poses;
  for (const topomap::StopPose& stop : stops) {
    if (stop.located) poses.emplace(stop.stop, stop.T_map_robot);
  }
  return poses;
}

RoomNumbers::Point RoomNumbers::point_at(const Eigen::Vector2d& position_m, const Poses& poses) {
  Point point{std::nullopt, position_m};
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const auto& [key, T_map_stop] : poses) {
    const double away_m = (T_map_stop.position_m() - position_m).norm();
    if (away_m >= nearest_m) continue;
    nearest_m = away_m;
    point = {key, inverse(T_map_stop) * position_m};
  }
  return point;
}

std::optional<Eigen::Vector2d> RoomNumbers::position_of(const Point& point, const Poses& poses) {
  if (!point.stop) return point.position_m;
  const auto found = poses.find(*point.stop);
  if (found == poses.end()) return std::nullopt;
  return found->second * point.position_m;
}

void RoomNumbers::find_again(const GridFrame& frame, const Poses& poses, ZoneMap& zones) const {
  // Common floor in cells, room, zone.
  std::vector<std::tuple<double, const Room*, ZoneId>> common;
  for (const Room& room : rooms_) {
    std::map<ZoneId, std::size_t> votes;
    for (const Point& point : room.points) {
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
  std::vector<const Room*> taken;
  for (const auto& [cells, room, id] : common) {
    Zone& zone = zones.zones[id];
    if (zone.room != 0 || std::find(taken.begin(), taken.end(), room) != taken.end()) continue;
    if (cells < kSame * static_cast<double>(std::min(room->cells, zone.cells))) continue;
    zone.room = room->number;
    if (zone.name.empty()) zone.name = room->name;
    taken.push_back(room);
  }
}

void RoomNumbers::keep_places(const GridFrame& frame, const Poses& poses, const ZoneMap& zones,
                              std::vector<Place>& places) {
  for (Place& place : places) {
    const auto kept = places_.find(place.name);
    const auto room_at = [&](const Eigen::Vector2d& at_m) {
      const ZoneId zone = zone_at(frame, zones, at_m);
      return zone == kNoZone ? 0 : zones.zones[zone].room;
    };
    const std::uint32_t room = room_at(place.position_m);
    if (kept == places_.end()) {
      if (room != 0) places_[place.name] = {room, point_at(place.position_m, poses)};
      continue;
    }
    if (room == kept->second.room) continue;
    const auto moved_m = position_of(kept->second.point, poses);
    if (moved_m && room_at(*moved_m) == kept->second.room) place.position_m = *moved_m;
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
    zone.name = named ? found->second.front()->name : name_of(zone.room);
  }
}

void RoomNumbers::remember(const GridFrame& frame, const Poses& poses, const ZoneMap& zones) {
  constexpr std::size_t kPoints = 64;  // a share is then exact to some per cent
  rooms_.clear();
  for (const Zone& zone : zones.zones) {
    const bool named = zone.name != name_of(zone.room);
    rooms_.push_back({zone.room, zone.cells, {}, named ? zone.name : ""});
  }
  std::vector<std::size_t> seen(zones.zones.size(), 0);
  for (std::size_t i = 0; i < zones.zone_of_cell.size(); ++i) {
    const ZoneId zone = zones.zone_of_cell[i];
    if (zone == kNoZone) continue;
    // Evenly over its cells.
    const std::size_t cells = zones.zones[zone].cells;
    const std::size_t wanted = std::min(kPoints, cells);
    const std::size_t before = seen[zone] * wanted / cells;
    ++seen[zone];
    if (seen[zone] * wanted / cells == before) continue;
    rooms_[zone].points.push_back(point_at(frame.center_m(frame.cell_at(i)), poses));
  }
}

}  // namespace topogeo::planning
