// Persistent numbers and names of rooms while a map is made: it grows, rooms are merged and split,
// and a closed loop moves all of it.
//
// Each room is remembered by points in it, each stored relative to the stop nearest to it, so that
// it moves with the map. A room of the next map is matched to the remembered room with which it
// shares most floor. If two rooms were merged, the one with more of the floor gives its number; if
// a room was split, its larger part keeps the number. A room that is gone keeps its number too, in
// case it comes back.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/room_memory.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::planning {

class RoomNumbers {
 public:
  RoomNumbers() = default;
  /// Continues with the memory of another instance.
  explicit RoomNumbers(RoomMemory memory) : memory_(std::move(memory)) {}

  /// Sets Zone::room: the earlier number for known rooms, the next ones, from 1 on in the order of
  /// the zones, for new rooms that are drawn, hold a place or are seen well. Others have none yet:
  /// stripes that a laser saw through doors. A zone without a name gets that of its room: of the
  /// only place in it, or "room NUMBER". If the map has moved and a place lies outside of its room
  /// now, it is moved and turned with the room. `stops` is empty for floors that do not move; they
  /// count as seen.
  void assign(const FreeSpace& space, std::span<const topomap::StopPose> stops, ZoneMap& zones,
              std::vector<Place>& places);

  [[nodiscard]] const RoomMemory& memory() const { return memory_; }

 private:
  static RoomPoint point_at(const Eigen::Vector2d& position_m, const StopPoses& poses);
  void find_again(const GridFrame& frame, const StopPoses& poses, ZoneMap& zones) const;
  void give_new_numbers(const FreeSpace& space, const StopPoses& poses,
                        const std::vector<Place>& places, ZoneMap& zones);
  void keep_places(const GridFrame& frame, const StopPoses& poses, const ZoneMap& zones,
                   std::vector<Place>& places);
  void name(const GridFrame& frame, const std::vector<Place>& places, ZoneMap& zones) const;
  void keep_gone(const StopPoses& poses, std::span<const RememberedRoom> anew);
  void remember(const GridFrame& frame, const StopPoses& poses, const ZoneMap& zones);

  RoomMemory memory_;
  std::vector<RememberedRoom> gone_;  // not in the last map, not stored
};

}  // namespace topogeo::planning
