// One map made by several robots at the same time (docs/algorithms.md, "Several robots, one map").
//
// Each session of a robot is mapped in a pose graph of its own, as if the robot were alone: a part
// of the map. Each robot is searched in the maps of the others (Meeting). When its pose is certain,
// the two maps become one, at once or after an operator agrees. Then the newest stops of each robot
// are matched with the others' views, and all measurements together determine all poses
// (place_jointly). The map is that of the first part; parts that have not joined it wait.
//
// The result depends only on the stops and the order of their arrival.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "topogeo/session/merge_proposals.hpp"
#include "topogeo/slam/slam.hpp"

namespace topogeo::localization {

class RobotParts;
class SharedPool;
class StopNumbers;
struct RobotPart;

class SharedMap : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// A session that has not joined the map within this many stops restarts with the next stop.
  static constexpr std::size_t kMostApart = 2048;
  /// Begins a map, or continues a stored one. The pool must outlive this and have no other user.
  /// Throws std::invalid_argument in SlamAlgorithm::kThesis.
  SharedMap(const LocalizerConfig& config, MatchPool& pool,
            const std::shared_ptr<const StoredMap>& stored = nullptr,
            std::size_t most_apart = kMostApart);
  ~SharedMap() override;

  /// Adds the next stop of a robot. A stop that follows one of the stored map continues from there;
  /// another session is another drive, whose pose is searched. Throws std::invalid_argument if a
  /// stop is not the next one of its session.
  bool add(MapPointer map) override;
  /// Compares all stops of robots in one map once more; more stops may still follow.
  void finish() override;

  /// All proposals; with `merge: auto` they are accepted at once.
  [[nodiscard]] const std::vector<MergeProposal>& proposals() const { return proposals_.all(); }
  /// Throw std::invalid_argument unless a proposal with this number is open.
  void accept(std::uint32_t number);
  void refuse(std::uint32_t number);
  /// Two stops of a proposal that was refused before this map was started.
  void remember_refused(const topomap::StopId& stop, const topomap::StopId& other) {
    proposals_.remember_refused(stop, other);
  }

  /// The map of the first part and all parts that have joined it, part by part.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const override { return edges_; }
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  /// Empty: each part has its own numbers for its decisions.
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override;
  /// The same map in the form for storage.
  [[nodiscard]] StoredMap map() const;

  /// For the robot whose stop came last.
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] LocalizationStatus status() const override { return status(last_robot_); }
  /// For any robot: not located, and searching, while its map has not joined.
  [[nodiscard]] std::optional<topomap::StopPose> last_stop(const std::string& robot) const;
  [[nodiscard]] LocalizationStatus status(const std::string& robot) const;
  /// Whether the robot's stops are part of the map.
  [[nodiscard]] bool joined(const std::string& robot) const;
  /// Number of stops that have not joined the map.
  [[nodiscard]] std::size_t stops_apart() const;
  [[nodiscard]] SlamCounts counts() const override;

 private:
  struct Due {
    std::size_t links = 0;  // since the group was last placed
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
  struct Own;
  std::unique_ptr<Own> own_;  // the next three
  SharedPool& pool_;
  RobotParts& parts_;
  StopNumbers& numbers_;
  std::map<std::uint32_t, Due> due_;  // by group
  MergeProposals proposals_;
  std::vector<PoseGraphEdge> edges_;
  std::string last_robot_;
  std::uint64_t version_ = 0;
  std::uint64_t placed_ = 0;  // number of joint optimisations
};

}  // namespace topogeo::localization
