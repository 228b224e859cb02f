// Follows a robot in a finished map that stays as it is (spec A9): every stop of the drive is
// matched with the stored stops that should look alike from where odometry has it.
//
// What the stops of the drive have in common with each other gives odometry only, so errors do not
// grow along the way. Where the state monitor says that the robot is lost, and at the start without
// a pose, every stop is searched for in the whole map; the places that fit are kept, moved along
// with odometry, and weighed by what the following stops see, until one of them is left. All
// matching goes through the pool, and the result does not depend on who answered or when.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/state_monitor.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/tracking/global_localization.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// What is known at one stop of the drive.
struct LocalizedStop {
  std::uint32_t id = 0;  ///< of the drive's local map
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_map_robot;                           ///< means nothing when searching or lost
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  Belief belief;
  std::uint32_t believed_matches = 0;
};

/// What a tracked stop was judged by.
struct TrackedStep {
  UncertainPose predicted;  ///< T_map_robot by odometry from the stop before
  StepEvidence evidence;
  std::vector<geometry::Pose2> measured;  ///< T_map_robot by each of the matches
  std::vector<StoredMatch> believed;      ///< the accepted ones of them
};

class MapLocalizer : public Slam {
 public:
  /// Starts without a pose. The pool must outlive the localizer. `first_drive_id` is the id of the
  /// first local map of the drive. Throws like GlobalLocalizer.
  MapLocalizer(LocalizerConfig config, std::shared_ptr<const StoredMap> map, MatchPool& pool,
               std::uint32_t first_drive_id = 0);

  /// The next stop of the drive; ids count on from the first. Throws std::invalid_argument
  /// otherwise. In the pool and in tasks the map has the id that follows those of the stored maps.
  /// False: no earlier pose moves.
  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Nothing is left to be done after the last map.
  void finish() override {}

  /// The robot is there, at its last stop or, before the first one, at that. Ends a search.
  void set_pose(const geometry::Pose2& T_map_robot, const Eigen::Matrix3d& covariance);

  /// The robot goes on from a stop of its own that is no stop of this drive: the last one of the
  /// map, when that has just been made. Before the first stop.
  void start_after(const topomap::LocalMap& map, const geometry::Pose2& T_map_robot);

  /// Numbers its tasks on from there; numbers are not to come twice in one pool.
  void number_tasks_from(std::uint64_t next_task) { next_task_ = next_task; }
  [[nodiscard]] std::uint64_t next_task() const { return next_task_; }

  /// Forgets the pose and searches the whole map from the next stop on.
  void search();

  /// All stops so far.
  [[nodiscard]] const std::vector<LocalizedStop>& stops() const { return stops_; }
  /// The same as a trajectory in the frame of the map.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  /// None: the map stays as it is.
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override { return {}; }
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return no_decisions_;
  }
  [[nodiscard]] Belief belief() const override { return belief_; }
  [[nodiscard]] SlamCounts counts() const override { return counts_; }
  /// Of the last stop; nothing when that was searched for.
  [[nodiscard]] const std::optional<TrackedStep>& last_step() const { return last_step_; }
  [[nodiscard]] std::size_t searches() const { return searches_; }
  /// Id of the stop of the finished map that a map of the drive is given after: the number of
  /// stored maps.
  [[nodiscard]] std::uint32_t first_id() const {
    return static_cast<std::uint32_t>(map_->maps.size());
  }

 private:
  /// A place where the robot may be.
  struct Hypothesis {
    UncertainPose pose;        // T_map_robot
    double weight = 0.0;       // probability, together with the others and "elsewhere" 1
    std::uint32_t seen = 0;    // stops that were matched there and believed
    std::uint32_t wanted = 0;  // as many before it is taken
    double way_m = 0.0;        // driven since the first of them
    std::uint32_t missed = 0;  // stops in succession that were not believed there
  };
  struct Candidate {
    std::size_t stop = 0;  // index of the stored stop
    double overlap = 0.0;
  };
  struct Query;

  void track(const Query& query);
  [[nodiscard]] double better_elsewhere(const Query& query) const;
  void begin_search();
  void search_step(const Query& query);
  void propose(const Query& query);
  void weigh(const Query& query);
  void decide();

  [[nodiscard]] std::vector<Candidate> candidates(const Query& query,
                                                  const UncertainPose& T_map_robot,
                                                  std::size_t count) const;
  MatchTask make_task(const Query& query, std::size_t stop, const UncertainPose& T_map_robot);
  [[nodiscard]] UncertainPose measured(std::size_t stop, const MatchResult& result) const;
  void count(const MatchResult& result);

  LocalizerConfig config_;
  std::shared_ptr<const StoredMap> map_;
  MatchPool& pool_;
  GlobalLocalizer global_;
  std::vector<std::uint64_t> hashes_;  // of the stored maps
  StateMonitor monitor_;
  UncertainPose pose_;  // T_map_robot at the last stop
  bool has_pose_ = false;
  std::vector<Hypothesis> hypotheses_;
  std::uint32_t searched_ = 0;                  // stops of the search in hand
  std::optional<geometry::Pose2> T_odom_last_;  // nothing before the first stop
  std::vector<LocalizedStop> stops_;
  std::optional<TrackedStep> last_step_;
  Belief belief_;
  std::uint32_t believed_ = 0;  // matches of the step in hand
  std::uint64_t next_task_ = 0;
  std::size_t searches_ = 0;
  std::uint32_t first_drive_id_ = 0;
  std::vector<LoopDecision> no_decisions_;
  SlamCounts counts_;
};

/// The most likely pose of several measurements of one pose in one frame; at least one. Their
/// covariances must be positive definite.
UncertainPose fused(const std::vector<UncertainPose>& measurements);

}  // namespace topogeo::localization
