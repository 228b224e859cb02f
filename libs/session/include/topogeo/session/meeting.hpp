// Searches the pose of one robot in the map of others while all of them drive on.
//
// A MapTracker follows the robot in a copy of their map, which is renewed when the map has grown:
// so the robot that reaches a place second finds that the other was there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/place_confirmation.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// A stop of the robot, matched with a stop of the others.
struct Sighting {
  topomap::StopId stop;   ///< of the robot
  topomap::StopId other;  ///< of the others
  UncertainPose T_other_stop;
  double fitness = 0.0;  ///< [0, 1]
};

class Meeting {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  Meeting(const LocalizerConfig& config, std::unique_ptr<MatchPool> pool);

  /// True if it needs a copy of their map: at first, and when the map has grown
  /// noticeably or has lost stops.
  [[nodiscard]] bool wants_map(std::size_t stops) const;
  /// Stops have left their map, so a new copy is needed.
  void renew() { renew_at_ = 0; }
  /// Sets a copy of their map. Unless the robot is followed, its last stops, in the order of their
  /// numbers, are searched in it again.
  void set_map(std::shared_ptr<const StoredMap> map, std::span<const MapPointer> last_stops);
  /// Sets the pose of the last stop in their map from another source; ignored while the robot is
  /// followed.
  void expect(const MapPointer& last, const UncertainPose& T_map_robot);

  /// Adds the next stop of the robot. True if its pose is certain (PlaceConfirmation).
  bool add(const MapPointer& map);

  /// T_map_robot of the last stop; meaningless unless it is certain.
  [[nodiscard]] geometry::Pose2 T_map_robot() const {
    return map_tracker_->last_stop()->T_map_robot;
  }
  [[nodiscard]] double confidence() const { return map_tracker_->status().confidence; }
  [[nodiscard]] const PlaceConfirmation& confirmation() const { return confirmation_; }
  /// All sightings since the robot has been followed without interruption.
  [[nodiscard]] const std::vector<Sighting>& sightings() const { return sightings_; }
  /// The sightings of the last stop.
  [[nodiscard]] std::span<const Sighting> newest() const;
  /// Restarts the search, because its sightings were wrong.
  void forget();
  [[nodiscard]] SlamCounts counts() const;

 private:
  void follow(const MapPointer& map);

  LocalizerConfig config_;
  std::unique_ptr<MatchPool> pool_;
  std::shared_ptr<const StoredMap> map_;
  std::unique_ptr<MapTracker> map_tracker_;
  PlaceConfirmation confirmation_;
  std::vector<Sighting> sightings_;
  std::size_t newest_ = 0;  // index of the first newest one
  MapPointer last_;
  std::size_t renew_at_ = 0;
  SlamCounts counts_before_;
};

}  // namespace topogeo::localization
