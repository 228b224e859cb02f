// Which maps of robots may be joined when a person wants to be asked (`merge: ask`): what was
// found, what was answered, and when to ask again.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/localization/session/meeting.hpp"

namespace topogeo::localization {

/// Two maps seem to show one place.
struct MergeProposal {
  enum class State : std::uint8_t {
    kOpen = 0,
    kAccepted = 1,
    kRefused = 2,
    kWithdrawn = 3  ///< one of the maps is not there any more
  };
  std::uint32_t number = 0;  ///< counts the proposals from 1
  State state = State::kOpen;
  std::string robot;            ///< that was followed ...
  std::string other_robot;      ///< ... where this one had mapped
  Sighting place;               ///< the newest stop that was matched
  geometry::Pose2 T_other_own;  ///< of the robot's map in that of the other
  double confidence = 0.0;      ///< that the robot is there, [0, 1]
  std::uint32_t stops = 0;      ///< followed in succession
  double distance_m = 0.0;      ///< driven meanwhile
  std::uint32_t matches = 0;    ///< of these stops, accepted
  double fitness = 0.0;         ///< their mean, [0, 1]
  double contradicted = 0.0;    ///< share of what should look alike that does not, [0, 1]
};

class MergeProposals {
 public:
  /// Where a stop is, and in which map: poses in one map can be compared. Nothing when it is gone.
  struct Placed {
    std::uint32_t map = 0;
    geometry::Pose2 T_map_robot;
  };
  using Find = std::function<std::optional<Placed>(const topomap::StopId&)>;

  /// What was found about two maps. Another one about the same two replaces what an open proposal
  /// states. False when a refused one was about the same two places: asked again is only when
  /// either map has another place that the other one shows, 10 m away, and twice as far with each
  /// refusal.
  bool offer(MergeProposal found, const Find& find);

  /// Two stops that do not show one place, from before: heeded like a refusal, but not shown.
  void remember_refused(const topomap::StopId& stop, const topomap::StopId& other) {
    refused_before_.emplace_back(stop, other);
  }

  /// Throws std::invalid_argument unless that one is open.
  MergeProposal accept(std::uint32_t number) {
    return decide(number, MergeProposal::State::kAccepted);
  }
  MergeProposal refuse(std::uint32_t number) {
    return decide(number, MergeProposal::State::kRefused);
  }
  /// Withdraws open ones of maps that are gone, and takes those for accepted whose two maps have
  /// become one.
  void check(const Find& find);

  /// In the order of their numbers.
  [[nodiscard]] const std::vector<MergeProposal>& all() const { return proposals_; }

 private:
  MergeProposal decide(std::uint32_t number, MergeProposal::State state);
  [[nodiscard]] bool refused_there(const MergeProposal& found, const Find& find) const;

  std::vector<MergeProposal> proposals_;
  std::vector<std::pair<topomap::StopId, topomap::StopId>> refused_before_;
  std::uint32_t next_ = 1;
};

}  // namespace topogeo::localization
