// Corrects the pose of every stop by matching its local map against earlier ones (spec A6), and
// spreads closed loops over the way between by least squares.
//
// The source takes the single match with the largest fitness; here all matches that pass the gates
// become edges of a pose graph, which real logs showed to be 3-10 times more accurate at no more
// cost. Matches are handed to a MatchPool as independent tasks; all answers of one round are
// awaited before any is used, so the result does not depend on who answered or when.
//
// A step moves the newest pose alone. What a closed loop does to the poses before is worked out
// beside the steps (GraphOptimizer) and takes effect a fixed number of steps later, whenever it was
// ready: a log gives the same poses however long that took.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/localization/mapping/graph_optimization.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/odometry_monitor.hpp"
#include "topogeo/localization/mapping/pose_graph.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/state_monitor.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/match_features.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// What a localizer of this configuration asks about two maps of which a relative pose is
/// predicted: the search space and all settings. The caller names the maps and gives id and seed.
MatchTask match_task(const LocalizerConfig& config, const UncertainPose& T_reference_query);

class Localizer : public Slam {
 public:
  /// The pool and the optimizer must outlive the localizer; without an optimizer the work is done
  /// within the step at which it takes effect.
  Localizer(LocalizerConfig config, MatchPool& pool, GraphOptimizer* optimizer = nullptr);

  /// Goes on with a stored map: its stops are the first, in its frame. A drive becomes part of it
  /// through join(). Throws std::invalid_argument when the map has no stops or the ids of its local
  /// maps are not their indices.
  Localizer(LocalizerConfig config, MatchPool& pool, GraphOptimizer* optimizer,
            const std::shared_ptr<const StoredMap>& stored);

  /// A drive to which no odometry leads from the last stop has found itself in the map: its stops
  /// so far, numbered on from those of the map, and matches of the last of them, at least one,
  /// which are right with this probability. The stops are mapped like others and placed by the
  /// matches, backwards from the last. Throws std::invalid_argument without stops or matches and
  /// like add().
  void join(std::span<const std::shared_ptr<const topomap::LocalMap>> drive,
            std::span<const StoredMatch> matches_of_last, double confidence);

  /// Numbers its tasks on from there; numbers are not to come twice in one pool.
  void number_tasks_from(std::uint64_t next_task) { next_task_ = next_task; }
  [[nodiscard]] std::uint64_t next_task() const { return next_task_; }

  /// One forward step. Maps must come in order of their ids, from 0, of one robot; throws
  /// std::invalid_argument otherwise. True when earlier poses were moved too.
  bool add(std::shared_ptr<const topomap::LocalMap> map) override;

  /// After the last map: matches all places that lie near each other by now and were not compared
  /// yet, and optimises, until nothing changes. Maps may follow all the same.
  void finish() override;

  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override;
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return decisions_;
  }
  [[nodiscard]] Belief belief() const override { return monitor_.belief(); }
  [[nodiscard]] SlamCounts counts() const override { return counts_; }

 private:
  struct Comparison {
    geometry::Pose2 T_later_earlier;  // as predicted then
    bool accepted = false;
  };
  struct Stop {
    std::shared_ptr<const topomap::LocalMap> map;
    std::uint64_t hash = 0;
    double way_m = 0.0;  // along the odometry from the first stop
    RangeProfile profile;
    std::vector<SurfacePoint> outline;  // some of its points, to foresee overlap
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    std::map<std::uint32_t, Comparison> compared;  // with earlier stops, by id
  };
  struct Candidate {
    std::uint32_t id = 0;
    double overlap = 0.0;
  };
  /// What came of a task that found something: an edge, and whether the gate let it through or had
  /// doubts.
  struct Answer {
    PoseGraphEdge edge;
    bool accepted = false;
    double fitness = 0.0;
  };
  /// A loop that moves the robot far, kept until another one agrees.
  struct PendingLoop {
    PoseGraphEdge edge;
    geometry::Pose2 correction;  // T_map_corrected * inverse(T_map_robot) at that time
  };
  struct Correction {
    geometry::Pose2 T_map_now;
    geometry::Pose2 T_map_corrected;
    [[nodiscard]] double way_m() const;
    [[nodiscard]] double turn_rad() const;
  };

  [[nodiscard]] topomap::StopPose pose_of(std::size_t stop) const;
  [[nodiscard]] static Stop described(std::shared_ptr<const topomap::LocalMap> map);
  void append(std::shared_ptr<const topomap::LocalMap> map);
  void restore(const StoredMap& stored, const std::shared_ptr<const topomap::LocalMap>& map);
  [[nodiscard]] UncertainPose way_to(
      std::span<const std::shared_ptr<const topomap::LocalMap>> drive,
      std::span<const StoredMatch> matches_of_last) const;
  void add_missing(std::span<const StoredMatch> matches_of_last);
  void settle();
  void match_recent(std::uint32_t stop, std::vector<StepMatch>& evidence);
  std::vector<MatchTask> recent_tasks(std::uint32_t stop,
                                      const std::vector<UncertainPose>& relative, double widening);
  void watch_odometry(const PoseGraphEdge& match);
  void match_revisited(std::uint32_t stop, std::vector<StepMatch>& evidence);
  [[nodiscard]] std::uint32_t first_recent(std::uint32_t stop) const;
  [[nodiscard]] Eigen::Matrix3d covariance_in_map(std::uint32_t stop) const;

  void add_loop(const Answer& answer);
  [[nodiscard]] Correction correction_of(const PoseGraphEdge& edge) const;
  [[nodiscard]] bool far(const Correction& correction) const;
  bool confirm(const PoseGraphEdge& edge, const Correction& correction);
  [[nodiscard]] bool closes(const Answer& answer) const;
  void believe(std::uint32_t stop, std::vector<StepMatch> matches);
  void decide(const PoseGraphEdge& edge, LoopOutcome outcome, Reason reason, double fitness);

  void start_optimization(std::uint32_t stop);
  bool finish_optimization(std::uint32_t stop);
  void apply(const GraphSolution& solution);
  void optimize_now();
  std::size_t match_revisits_of(std::span<const std::uint32_t> stops);
  [[nodiscard]] std::vector<std::uint32_t> moved_since(
      const std::vector<geometry::Pose2>& before) const;
  [[nodiscard]] PoseGraph::Reach searchable_reach() const;
  [[nodiscard]] GraphOptimizer& optimizer() { return optimizer_ ? *optimizer_ : in_place_; }

  [[nodiscard]] std::vector<Candidate> candidates(std::uint32_t stop,
                                                  std::span<const UncertainPose> relative,
                                                  bool recent, std::uint32_t count) const;
  [[nodiscard]] bool worth_comparing(std::uint32_t earlier, std::uint32_t later,
                                     const geometry::Pose2& T_later_earlier) const;
  [[nodiscard]] bool searchable(const UncertainPose& T_reference_query) const;
  MatchTask make_task(std::uint32_t reference, std::uint32_t query, const UncertainPose& prior);
  /// What came of the tasks; and, where wanted, what each says of the pose of this stop.
  std::vector<Answer> run(const std::vector<MatchTask>& tasks, EdgeKind kind,
                          std::vector<StepMatch>* evidence);

  LocalizerConfig config_;
  MatchPool& pool_;
  GraphOptimizer* optimizer_ = nullptr;
  InPlaceOptimizer in_place_;
  PoseGraph graph_;
  std::vector<Stop> stops_;
  std::vector<PendingLoop> pending_;
  std::vector<PoseGraphEdge> new_loops_;  // closed, but poses and covariances are those before
  std::optional<std::uint32_t> due_;      // step at which the running optimisation takes effect
  std::size_t started_loops_ = 0;         // of those, in the running optimisation
  bool optimization_wanted_ = false;
  std::size_t stored_stops_ = 0;      // that were there before the first own one
  std::optional<UncertainPose> gap_;  // to the next stop, where no odometry leads to it
  /// Of the sequential matches of the last stop, by the id of the older map: where a search for the
  /// next stop against the same map starts (spec A4).
  std::map<std::uint32_t, std::vector<MatchSolution>> last_solutions_;
  std::map<std::uint32_t, std::vector<MatchSolution>> new_solutions_;  // of this stop
  std::uint64_t version_ = 0;
  std::uint64_t next_task_ = 0;
  std::uint32_t loops_since_optimization_ = 0;
  OdometryMonitor odometry_;
  std::vector<LoopDecision> decisions_;
  StateMonitor monitor_;
  SlamCounts counts_;
};

}  // namespace topogeo::localization
