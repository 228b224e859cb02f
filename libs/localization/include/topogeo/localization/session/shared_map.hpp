// Several robots map one floor at a time (docs/algorithms.md, "Several robots, one map").
//
// Each session of a robot is mapped by its own localizer, as if the robot were alone: a part of the
// map. Each robot is looked for in what the others have mapped (Meeting). When its place is certain
// the two maps become one, at once or after somebody has agreed; from then on the newest stops of
// each are matched with what the others see there, and all poses follow from all measurements
// together (place_jointly). The map is that of the first part; what has not joined it waits.
//
// All of that follows from the stops in the order in which they come.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/session/merge_proposals.hpp"
#include "topogeo/localization/session/robot_parts.hpp"
#include "topogeo/localization/session/shared_pool.hpp"
#include "topogeo/localization/session/stop_numbers.hpp"

namespace topogeo::localization {

class SharedMap : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// A session that has not joined the map within so many stops begins anew with the next one.
  static constexpr std::size_t kMostApart = 2048;
  /// Begins a map, or goes on with a stored one. Nobody else uses the pool, which must outlive
  /// this. Throws std::invalid_argument in LocalizerMode::kThesis.
  SharedMap(const LocalizerConfig& config, MatchPool& pool,
            const std::shared_ptr<const StoredMap>& stored = nullptr,
            std::size_t most_apart = kMostApart);

  /// The next stop of a robot. One that follows a stop of the stored map goes on from there;
  /// another session is another drive, whose place is looked for. Throws std::invalid_argument
  /// when a stop is not the next one of its session.
  bool add(MapPointer map) override;
  /// Compares once more all that the robots of one map have seen; stops may follow all the same.
  void finish() override;

  /// Proposals so far; with `merge: auto` they are accepted at once.
  [[nodiscard]] const std::vector<MergeProposal>& proposals() const { return proposals_.all(); }
  /// Throw std::invalid_argument unless a proposal of this number is open.
  void accept(std::uint32_t number);
  void refuse(std::uint32_t number);
  /// Two stops of a proposal that was refused before this began.
  void remember_refused(const topomap::StopId& stop, const topomap::StopId& other) {
    proposals_.remember_refused(stop, other);
  }

  /// The map of the first part and all that have joined it: part by part.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const override { return edges_; }
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  /// None: each part decides by numbers of its own.
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override;
  /// The same map as it can be stored.
  [[nodiscard]] StoredMap map() const;

  /// Of the robot whose stop came last ...
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] LocalizationStatus status() const override { return status(last_robot_); }
  /// ... and of any: not located, and searching, while its map has not joined.
  [[nodiscard]] std::optional<topomap::StopPose> last_stop(const std::string& robot) const;
  [[nodiscard]] LocalizationStatus status(const std::string& robot) const;
  /// The robot's stops are part of the map.
  [[nodiscard]] bool joined(const std::string& robot) const;
  /// Stops that have not joined the map.
  [[nodiscard]] std::size_t stops_apart() const;
  [[nodiscard]] SlamCounts counts() const override;

 private:
  struct Due {
    std::size_t links = 0;  // since the group was placed
    std::size_t stops = 0;
    bool moved = false;
  };

  RobotPart& part_for(const topomap::LocalMap& map);
  void follow_on(RobotPart& part, const topomap::LocalMap& map);
  [[nodiscard]] MergeProposals::Find finder() const;

  void meet(RobotPart& part, const MapPointer& map);
  void meet_own(Meeting& meeting, const MapPointer& map);
  void propose(const RobotPart& part, const Meeting& meeting);
  void join(const MergeProposal& proposal);
  void compare_again(RobotPart& part);
  void prune();
  void close_loops(std::uint32_t group);
  void add_links(std::span<const Sighting> sightings, std::uint32_t group);
  void place(std::uint32_t group);
  void place_if_due(std::uint32_t group);
  void number_stops(bool all);

  LocalizerConfig config_;
  std::size_t most_apart_;
  SharedPool pool_;
  RobotParts parts_;
  std::map<std::uint32_t, Due> due_;  // by group
  MergeProposals proposals_;
  StopNumbers numbers_;
  std::vector<PoseGraphEdge> edges_;
  std::string last_robot_;
  std::uint64_t version_ = 0;
  std::uint64_t placed_ = 0;  // times that a group was
};

}  // namespace topogeo::localization
