// Interface of all algorithms that map and follow a robot from stop to stop: the pose graph over
// all accepted matches (pose_graph_slam.hpp), the thesis alone (thesis_slam.hpp), localization in a
// finished map (map_tracker.hpp), or a session of them (slam_session.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/slam/loop/loop_decision.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

struct MatchCounts {
  std::uint64_t tasks = 0;
  std::uint64_t evaluations = 0;
  std::array<std::uint64_t, kReasons> reasons{};  ///< index: Reason; kNone: accepted
};

struct SlamCounts : MatchCounts {
  std::uint64_t steps_in_doubt =
      0;  ///< no recent match was accepted; an uncertain one or odometry was used instead
  std::uint64_t unconfirmed_loops = 0;  ///< large corrections without an agreeing loop
  std::uint64_t optimizations = 0;
  std::uint64_t failed_optimizations = 0;  ///< without a usable result: poses kept
  std::uint64_t removed_loops = 0;         ///< contradicted by the rest after optimisation
};

class Slam {
 public:
  virtual ~Slam() = default;

  /// One forward step. Maps must come in order of their ids, from 0, of one robot; throws
  /// std::invalid_argument otherwise. True when earlier poses were moved too.
  virtual bool add(std::shared_ptr<const topomap::LocalMap> map) = 0;

  /// After the last map: does the work that needs all maps, or is better with them. More maps may
  /// still follow.
  virtual void finish() = 0;

  [[nodiscard]] virtual topomap::Trajectory trajectory() const = 0;
  /// Pose of the robot at its last stop; empty before the first.
  [[nodiscard]] virtual std::optional<topomap::StopPose> last_stop() const = 0;
  [[nodiscard]] virtual std::vector<topomap::LoopClosure> loop_closures() const = 0;
  /// Every loop that was considered so far, in the order of the decisions.
  [[nodiscard]] virtual const std::vector<LoopDecision>& loop_decisions() const = 0;
  /// All measurements between the poses, if known; otherwise empty.
  [[nodiscard]] virtual const std::vector<PoseGraphEdge>& edges() const { return no_edges(); }
  /// How well the pose of the last stop is known.
  [[nodiscard]] virtual LocalizationStatus status() const = 0;
  [[nodiscard]] virtual SlamCounts counts() const = 0;

 protected:
  static const std::vector<PoseGraphEdge>& no_edges() {
    static const std::vector<PoseGraphEdge> none;
    return none;
  }
  static const std::vector<LoopDecision>& no_decisions() {
    static const std::vector<LoopDecision> none;
    return none;
  }
  Slam() = default;
  Slam(const Slam&) = default;
  Slam& operator=(const Slam&) = default;
};

/// Checks that `map` is the robot's next one: throws std::invalid_argument unless its id is
/// `next_id` and its robot is that of `first`, if set.
void check_next(const topomap::LocalMap& map, std::size_t next_id, const topomap::LocalMap* first);
/// Throws std::invalid_argument unless both are of one robot.
void check_robot(const topomap::LocalMap& map, const topomap::LocalMap& first);
/// Throws std::invalid_argument unless `stop` is the one after `last`.
void check_follows(const topomap::StopId& stop, const topomap::StopId& last);

}  // namespace topogeo::localization
