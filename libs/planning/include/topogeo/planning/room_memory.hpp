// Stored data about the rooms of a map, to recognize them in the next one: RoomNumbers makes and
// uses it, map files store it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::planning {

/// A point of the floor, relative to a stop.
struct RoomPoint {
  std::optional<topomap::StopId> stop;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< in its frame; map frame without one

  friend bool operator==(const RoomPoint&, const RoomPoint&) = default;
};

/// Poses of stops in the map frame.
using StopPoses = std::map<topomap::StopId, geometry::Pose2>;

/// The poses of the located ones.
StopPoses poses_of(std::span<const topomap::StopPose> stops);

/// Where a point lies, map frame; nothing if its stop is not among them.
std::optional<Eigen::Vector2d> position_of(const RoomPoint& point, const StopPoses& poses);

/// The name of a room that has none of its own: "room 7".
std::string room_name(std::uint32_t number);

struct RememberedRoom {
  std::uint32_t number = 0;  ///< > 0
  std::size_t cells = 0;     ///< of its zone
  std::vector<RoomPoint> points;
  std::string name;  ///< "" unless it differs from that of its number

  friend bool operator==(const RememberedRoom&, const RememberedRoom&) = default;
};

/// A place that lies in a room.
struct RememberedPlace {
  Place drawn;  ///< from the drawing; a redrawn place does not match
  std::uint32_t room = 0;
  RoomPoint point;
  double stop_heading_rad = 0.0;  ///< of the stop of `point` at that time, map frame; 0 without one

  friend bool operator==(const RememberedPlace&, const RememberedPlace&) = default;
};

struct RoomMemory {
  std::vector<RememberedRoom> rooms;  ///< by number
  std::vector<RememberedPlace> places;
  std::uint32_t last = 0;  ///< last assigned number

  [[nodiscard]] bool empty() const { return last == 0 && rooms.empty() && places.empty(); }
  friend bool operator==(const RoomMemory&, const RoomMemory&) = default;
};

}  // namespace topogeo::planning
