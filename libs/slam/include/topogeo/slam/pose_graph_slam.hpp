// SLAM back end: corrects the pose of every stop by matching its local map against earlier ones,
// and spreads closed loops over the stops between by least squares (docs/algorithms.md, "Pose
// graph").
//
// The thesis (7.3.1.1, eq. 7.18) takes the single match with the largest fitness; here all matches
// that pass the gates become edges of a pose graph, which was 3-10 times more accurate on real logs
// at no more cost.
//
// A step moves only the newest pose. The effect of a closed loop on earlier poses is computed
// beside the steps and applied a fixed number of steps later (OptimizationSchedule).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/pose_graph.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/support/value_pointer.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

struct FinishedOptimization;
class GraphOptimizer;
struct GraphSolution;
struct StopMatch;

class PoseGraphSlam : public Slam {
 public:
  using MapPointer = std::shared_ptr<const topomap::LocalMap>;

  /// The pool and the optimizer must outlive this. Without an optimizer the work is done
  /// within the step at which it takes effect.
  PoseGraphSlam(const LocalizerConfig& config, MatchPool& pool,
                GraphOptimizer* optimizer = nullptr);

  /// Continues a stored map: its stops come first, and its frame is kept. A drive becomes part of
  /// it through join(). Throws std::invalid_argument if the map has no stops or the ids of its
  /// local maps are not their indices.
  PoseGraphSlam(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
                const std::shared_ptr<const StoredMap>& stored);
  PoseGraphSlam(const PoseGraphSlam& other);
  PoseGraphSlam& operator=(const PoseGraphSlam&) = delete;
  ~PoseGraphSlam() override;

  /// Adds a drive that was localized in the map but is not connected to the last stop by odometry.
  /// `drive` holds its stops so far, numbered on from those of the map; `matches_of_last` are one
  /// or more matches of its last stop that are right with the probability `confidence`. The stops
  /// are matched with each other, placed backwards from the last one by these matches, and then
  /// compared with the map. Throws std::invalid_argument without stops or matches and like add().
  void join(std::span<const MapPointer> drive, std::span<const StoredMatch> matches_of_last,
            double confidence);

  /// Applies the optimisation that is still running, if any.
  void settle();

  /// Continues the numbering of tasks there; no number may occur twice in one pool.
  void number_tasks_from(std::uint64_t next_task);
  [[nodiscard]] std::uint64_t next_task() const;

  /// One forward step. Maps must come in order of their ids, from 0, of one robot; throws
  /// std::invalid_argument otherwise. True when earlier poses were moved too.
  bool add(MapPointer map) override;

  /// After the last map: matches all stops that lie near each other by now and were not compared
  /// yet, and optimises, until nothing changes. More maps may still follow.
  void finish() override;

  /// Like finish(), but with the stops of a stored map from `first` on, which finish() leaves
  /// alone: for a map whose parts were made separately.
  void compare_stored(std::uint32_t first);

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override;
  /// Empty if it continues a stored map without edges.
  [[nodiscard]] const std::vector<PoseGraphEdge>& edges() const override {
    return edges_known_ ? graph_.edges() : no_edges();
  }
  [[nodiscard]] LocalizationStatus status() const override { return monitor_.status(); }
  [[nodiscard]] SlamCounts counts() const override;
  /// The stops and all measurements between them.
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

  bool apply(const std::optional<FinishedOptimization>& finished);
  void update_covariances(const GraphSolution& solution);
  void rescale_steps();
  void optimize_now();
  void close_all_loops(std::uint32_t first);
  std::size_t close_more_loops(std::span<const std::uint32_t> stops);

  LocalizerConfig config_;
  struct Parts;
  support::ValuePointer<Parts> parts_;
  PoseGraph graph_;
  std::vector<Eigen::Matrix3d> covariances_;  // of the poses in the map frame
  StateMonitor monitor_;
  std::size_t stored_stops_ = 0;      // number of stops in the stored map
  std::optional<UncertainPose> gap_;  // T_last_next, when no odometry leads to the next stop
  bool edges_known_ = true;
  std::uint64_t version_ = 0;
  std::uint64_t steps_in_doubt_ = 0;
};

}  // namespace topogeo::localization
