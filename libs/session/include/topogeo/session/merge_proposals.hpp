// Proposals to join the maps of robots when an operator decides (`merge: ask`): their evidence, the
// answers, and when to ask again.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/session/meeting.hpp"

namespace topogeo::localization {

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
