// Looks for the place of one robot in what others have mapped, while all of them drive on.
//
// A MapLocalizer follows the robot in a copy of their map, which is taken anew when the map has
// grown: so the robot that comes to a place second finds that the other was there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/session/place_confirmation.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

/// A stop of the robot, as it was matched with one of the others.
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

  /// True when their map has to be given: at first, and when it has grown to so many stops that it
  /// shows noticeably more.
  [[nodiscard]] bool wants_map(std::size_t stops) const;
  /// Stops have left their map: it has to be given again.
  void renew() { renew_at_ = 0; }
  /// Their map, as it is now. The last stops of the robot, in the order of their numbers, are
  /// looked for in it anew, unless it is followed.
  void set_map(std::shared_ptr<const StoredMap> map, std::span<const MapPointer> last_stops);
  /// Where the last stop is in their map, from elsewhere; counts unless the robot is followed.
  void expect(const MapPointer& last, const UncertainPose& T_map_robot);

  /// The next stop of the robot. True when its place is certain (PlaceConfirmation).
  bool add(const MapPointer& map);

  /// T_map_robot of the last stop; means nothing unless it is certain.
  [[nodiscard]] geometry::Pose2 T_map_robot() const { return follower_->last_stop()->T_map_robot; }
  [[nodiscard]] double confidence() const { return follower_->status().confidence; }
  [[nodiscard]] const PlaceConfirmation& confirmation() const { return confirmation_; }
  /// What was seen since the robot is followed without a break.
  [[nodiscard]] const std::vector<Sighting>& sightings() const { return sightings_; }
  /// The same of the last stop alone.
  [[nodiscard]] std::span<const Sighting> newest() const;
  /// Begins to look anew: what it has seen was wrong.
  void forget();
  [[nodiscard]] SlamCounts counts() const;

 private:
  void follow(const MapPointer& map);

  LocalizerConfig config_;
  std::unique_ptr<MatchPool> pool_;
  std::shared_ptr<const StoredMap> map_;
  std::unique_ptr<MapLocalizer> follower_;
  PlaceConfirmation confirmation_;
  std::vector<Sighting> sightings_;
  std::size_t newest_ = 0;  // of these
  MapPointer last_;
  std::size_t renew_at_ = 0;
  SlamCounts counts_before_;
};

}  // namespace topogeo::localization
