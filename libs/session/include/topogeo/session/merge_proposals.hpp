// Meetings of robots: the pose of one in the map of others, and proposals to merge their maps,
// which wait for an operator.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/place_confirmation.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::localization {

// Searches the pose of one robot in the map of others while all of them drive on.
//
// A MapTracker follows the robot in a copy of their map, which is renewed when the map has grown:
// so the robot that reaches a place second finds that the other was there.

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

/// Two maps seem to show one place.
struct MergeProposal {
  enum class State : std::uint8_t {
    kOpen = 0,
    kAccepted = 1,
    kRefused = 2,
    kWithdrawn = 3  ///< one of the maps no longer exists
  };
  std::uint32_t number = 0;  ///< counts the proposals from 1
  State state = State::kOpen;
  std::string robot;            ///< the robot that was followed in ...
  std::string other_robot;      ///< ... the map of this robot
  Sighting place;               ///< the newest stop that was matched
  geometry::Pose2 T_other_own;  ///< pose of the robot's map in the other one
  double confidence = 0.0;      ///< probability that the robot is there, [0, 1]
  std::uint32_t stops = 0;      ///< followed in succession
  double distance_m = 0.0;      ///< driven meanwhile
  std::uint32_t matches = 0;    ///< accepted matches of these stops
  double fitness = 0.0;         ///< their mean, [0, 1]
  double contradicted = 0.0;    ///< share of the expected common view that contradicts, [0, 1]
};

class MergeProposals {
 public:
  /// Pose of a stop and its map; only poses in one map can be compared. Empty if the stop is gone.
  struct Placed {
    std::uint32_t map = 0;
    geometry::Pose2 T_map_robot;
  };
  using Find = std::function<std::optional<Placed>(const topomap::StopId&)>;

  /// Offers evidence about two maps. It replaces the evidence of an open proposal about the same
  /// two. Returns false if a proposal for nearby places was refused: the question is repeated only
  /// when either map shows another place of the other, 10 m away, and twice as far after each
  /// refusal.
  bool offer(MergeProposal found, const Find& find);

  /// Two stops of an earlier refusal: respected, but not listed.
  void remember_refused(const topomap::StopId& stop, const topomap::StopId& other) {
    refused_before_.emplace_back(stop, other);
  }

  /// Throws std::invalid_argument unless this proposal is open.
  MergeProposal accept(std::uint32_t number) {
    return decide(number, MergeProposal::State::kAccepted);
  }
  MergeProposal refuse(std::uint32_t number) {
    return decide(number, MergeProposal::State::kRefused);
  }
  /// Withdraws open proposals whose maps are gone, and accepts those whose two maps have become
  /// one.
  void check(const Find& find);

  /// Ordered by number.
  [[nodiscard]] const std::vector<MergeProposal>& all() const { return proposals_; }

 private:
  MergeProposal decide(std::uint32_t number, MergeProposal::State state);
  [[nodiscard]] bool refused_there(const MergeProposal& found, const Find& find) const;

  std::vector<MergeProposal> proposals_;
  std::vector<std::pair<topomap::StopId, topomap::StopId>> refused_before_;
  std::uint32_t next_ = 1;
};

}  // namespace topogeo::localization
