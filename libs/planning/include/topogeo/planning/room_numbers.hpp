// Numbers and names of rooms that stay with them while a map is made: it grows, rooms are joined
// and parted, and a closed loop moves all of it.
//
// Each room is remembered by points in it, and each of these by where it lies from the stop nearest
// to it, so that it moves with the map. A room of the next map is the one remembered that most of
// their common floor belongs to; of two that were joined the one that has more of it, and of one
// that was parted the larger part keeps the number.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/planning/free_space.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::planning {

class RoomNumbers {
 public:
  /// Sets Zone::room of all zones: of rooms seen before the number that they had, of others the
  /// next ones, from 1 on, in the order of the zones. A zone without a name gets that of its room:
  /// of the only place in it, or "room NUMBER". A place that has come to lie outside of its room,
  /// because the map has moved, is moved with the room. `stops` is empty for floors that do not
  /// move.
  void assign(const GridFrame& frame, std::span<const topomap::StopPose> stops, ZoneMap& zones,
              std::vector<Place>& places);

 private:
  struct Point {
    std::optional<topomap::StopId> stop;
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  // in its frame; map frame without one
  };
  struct Room {
    std::uint32_t number = 0;
    std::size_t cells = 0;
    std::vector<Point> points;
    std::string name;
  };
  struct KeptPlace {
    std::uint32_t room = 0;
    Point point;
  };
  using Poses = std::map<topomap::StopId, geometry::Pose2>;

  static Poses poses_of(std::span<const topomap::StopPose> stops);
  static Point point_at(const Eigen::Vector2d& position_m, const Poses& poses);
  static std::optional<Eigen::Vector2d> position_of(const Point& point, const Poses& poses);
  void find_again(const GridFrame& frame, const Poses& poses, ZoneMap& zones) const;
  void keep_places(const GridFrame& frame, const Poses& poses, const ZoneMap& zones,
                   std::vector<Place>& places);
  void name(const GridFrame& frame, const std::vector<Place>& places, ZoneMap& zones) const;
  void remember(const GridFrame& frame, const Poses& poses, const ZoneMap& zones);

  std::vector<Room> rooms_;
  std::map<std::string, KeptPlace> places_;
  std::uint32_t last_ = 0;
};

}  // namespace topogeo::planning
