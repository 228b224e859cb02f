// Corrects the pose of every stop by matching its local map against earlier ones, and spreads
// closed loops over the stops between by least squares (docs/algorithms.md, "Pose graph").
//
// The thesis (7.3.1.1, eq. 7.18) takes the single match with the largest fitness; here all matches
// that pass the gates become edges of a pose graph, which real logs showed to be 3-10 times more
// accurate at no more cost.
//
// A step moves the newest pose alone. What a closed loop does to earlier poses is worked out beside
// the steps and takes effect a fixed number of steps later (OptimizationSchedule).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/loop_closing.hpp"
#include "topogeo/localization/mapping/odometry_steps.hpp"
#include "topogeo/localization/mapping/optimization_schedule.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/state_monitor.hpp"
#include "topogeo/localization/mapping/stop_matching.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

class Localizer : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// The pool and the optimizer must outlive the localizer; without an optimizer the work is done
  /// within the step at which it takes effect.
  Localizer(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer = nullptr);

  /// Goes on with a stored map: its stops are the first, in its frame. A drive becomes part of it
  /// through join(). Throws std::invalid_argument when the map has no stops or the ids of its local
  /// maps are not their indices.
  Localizer(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
            const std::shared_ptr<const StoredMap>& stored);

  /// A drive to which no odometry leads from the last stop has found itself in the map: its stops
  /// so far, numbered on from those of the map, and matches of the last of them, at least one,
  /// which are right with this probability. The stops are matched with each other, placed by the
  /// matches, backwards from the last, and then compared with the map. Throws
  /// std::invalid_argument without stops or matches and like add().
  void join(std::span<const MapPointer> drive, std::span<const StoredMatch> matches_of_last,
            double confidence);

  /// Takes in what is still being worked out about earlier poses.
  void settle() { apply(schedule_.fetch_now()); }

  /// Numbers its tasks on from there; no number may occur twice in one pool.
  void number_tasks_from(std::uint64_t next_task) { matching_.requests().number_from(next_task); }
  [[nodiscard]] std::uint64_t next_task() const { return matching_.requests().next_task(); }

  /// One forward step. Maps must come in order of their ids, from 0, of one robot; throws
  /// std::invalid_argument otherwise. True when earlier poses were moved too.
  bool add(MapPointer map) override;

  /// After the last map: matches all places that lie near each other by now and were not compared
  /// yet, and optimises, until nothing changes. Maps may follow all the same.
  void finish() override;

  /// The same with the stops of a stored map from this one on, which finish() leaves alone: for a
  /// map whose parts were made apart.
  void compare_stored(std::uint32_t first);

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return loops_.decisions();
  }
  /// None where it goes on with a stored map that does not keep its own.
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const override {
    return edges_known_ ? graph_.edges() : no_edges();
  }
  [[nodiscard]] LocalizationStatus status() const override { return monitor_.status(); }
  [[nodiscard]] SlamCounts counts() const override;
  /// The stops and all that was measured between them.
  [[nodiscard]] const PoseGraph& graph() const { return graph_; }

 private:
  [[nodiscard]] std::uint32_t last() const;
  [[nodiscard]] topomap::StopPose pose_of(std::size_t stop) const;

  [[nodiscard]] const topomap::LocalMap* first_of_session(const topomap::LocalMap& map) const;
  void append(MapPointer map);
  void restore(MapPointer map, const topomap::StopPose& pose);
  std::vector<StepMatch> place_last();
  std::vector<StepMatch> match_recent();
  std::vector<StopMatch> match_further(std::vector<StopMatch>& matches);
  std::vector<StepMatch> match_revisited(std::span<const std::uint32_t> stops);
  void judge_state(std::vector<StepMatch> evidence);

  bool apply(const std::optional<OptimizationSchedule::Finished>& finished);
  void update_covariances(const GraphSolution& solution);
  void rescale_steps();
  void optimize_now();
  void close_all_loops(std::uint32_t first);
  std::size_t close_more_loops(std::span<const std::uint32_t> stops);

  LocalizerConfig config_;
  StopMatching matching_;
  PoseGraph graph_;
  std::vector<Eigen::Matrix3d> covariances_;  // of the poses in the map frame
  LoopClosing loops_;
  OptimizationSchedule schedule_;
  OdometrySteps steps_;
  StateMonitor monitor_;
  std::size_t stored_stops_ = 0;      // that were there before the first own one
  std::optional<UncertainPose> gap_;  // to the next stop, where no odometry leads to it
  bool edges_known_ = true;
  std::uint64_t version_ = 0;
  std::uint64_t steps_in_doubt_ = 0;
};

}  // namespace topogeo::localization
