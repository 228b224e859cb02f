// Follows a robot in a finished map that stays as it is (docs/algorithms.md, "Localization in a
// map"): every stop of the drive is matched with the stored stops that should look alike from where
// odometry has it.
//
// What the stops of the drive have in common with each other gives odometry only, so errors do not
// grow along the path. Where the state monitor reports that the robot is lost, and at the start
// without a pose, every stop is searched for in the whole map (PlaceSearch). All matching goes
// through the pool, and the result does not depend on who answered or when.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/mapping/state_monitor.hpp"
#include "topogeo/localization/mapping/stored_map.hpp"
#include "topogeo/localization/matching/match.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/tracking/continued_place.hpp"
#include "topogeo/localization/tracking/place_search.hpp"
#include "topogeo/localization/tracking/stored_map_matching.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// The state at one stop of the drive.
struct LocalizedStop {
  topomap::StopId stop;
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_map_robot;                           ///< means nothing when searching or lost
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  LocalizationStatus status;
  std::uint32_t accepted_matches = 0;
};

/// What a tracked stop was judged by.
struct TrackedStep {
  UncertainPose predicted;  ///< T_map_robot by odometry from the stop before
  StepEvidence evidence;
  std::vector<geometry::Pose2> measured;  ///< T_map_robot by each of the matches
  std::vector<StoredMatch> accepted;      ///< those of them that are accepted
  /// T_stop_robot of these by the scans alone, without what was predicted: for a pose graph, which
  /// has the prediction as a measurement of its own.
  std::vector<UncertainPose> scans_alone;
};

/// Where a robot was at the last stop of its drive.
struct LastPlace {
  UncertainPose T_map_robot;
  geometry::Pose2 T_odom_robot;
  std::uint64_t odometry_epoch = 0;  ///< as in scan::Scan
};

class MapLocalizer : public Slam {
 public:
  /// Starts without a pose. The pool must outlive the localizer. Throws like GlobalLocalizer.
  MapLocalizer(const LocalizerConfig& config, std::shared_ptr<const StoredMap> map,
               MatchPool& pool);

  /// The next stop of the drive: the numbers of a session count on from the first that comes.
  /// Throws std::invalid_argument otherwise. Another session goes on where the one before ended if
  /// its odometry has the same epoch (not 0) or the pose was set since. Otherwise it is another
  /// drive: the pose is forgotten and searched for. In the pool and in tasks the map has one of the
  /// ids that follow those of the stored maps. False: no earlier pose moves.
  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Nothing is left to be done after the last map.
  void finish() override {}

  /// The robot is there, at its last stop or, before the first one, at that. Ends a search.
  void set_pose(const geometry::Pose2& T_map_robot, const Eigen::Matrix3d& covariance);

  /// The robot goes on from a stop of its own that is no stop of this drive: the last one of the
  /// map, when that has just been made. Before the first stop.
  void start_after(const topomap::LocalMap& map, const geometry::Pose2& T_map_robot);
  /// The same with what is known of a drive before. A first stop whose odometry has another epoch
  /// is searched for.
  void start_after(const LastPlace& place);

  /// Numbers its tasks on from there; no number may occur twice in one pool.
  void number_tasks_from(std::uint64_t next_task) { matching_.requests().number_from(next_task); }
  [[nodiscard]] std::uint64_t next_task() const { return matching_.requests().next_task(); }

  /// Forgets the pose and searches the whole map from the next stop on.
  void search();

  /// Forgets all stops but the last ones, at least `most` of them. Those that are left have other
  /// numbers in the trajectory then.
  void forget_stops(std::size_t most);

  /// How many stops came, those that were forgotten too.
  [[nodiscard]] std::uint32_t added_stops() const { return added_; }
  /// All stops so far that were not forgotten.
  [[nodiscard]] const std::vector<LocalizedStop>& stops() const { return stops_; }
  /// The same as a trajectory in the frame of the map.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  /// None: the map stays as it is.
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override { return {}; }
  /// None.
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override;
  [[nodiscard]] LocalizationStatus status() const override { return status_; }
  [[nodiscard]] SlamCounts counts() const override;
  /// Of all stops so far, those that were forgotten too, by state.
  [[nodiscard]] const std::array<std::uint64_t, kLocalizationStates>& stops_by_state() const {
    return stops_by_state_;
  }
  /// Of the last stop; nothing when that was searched for.
  [[nodiscard]] const std::optional<TrackedStep>& last_step() const { return last_step_; }
  [[nodiscard]] std::size_t searches() const { return searches_; }
  /// Id of the stop of the finished map that a map of the drive is given after: the number of
  /// stored maps.
  [[nodiscard]] std::uint32_t first_id() const {
    return static_cast<std::uint32_t>(matching_.stored_stops());
  }

 private:
  void begin_session(std::uint64_t odometry_epoch);
  std::uint32_t track(const DriveStop& stop);
  std::vector<MatchTask> tracking_tasks(const DriveStop& stop,
                                        std::span<const MatchCandidate> stored);
  std::vector<bool> agreeing(std::span<const MatchTask> tasks, std::span<const MatchResult> results,
                             std::span<const MatchCandidate> stored);
  [[nodiscard]] double better_elsewhere(const DriveStop& stop) const;
  void compare_continued(const DriveStop& stop);
  void begin_search();
  void look_around(const DriveStop& stop);
  void match_hypotheses(const DriveStop& stop);
  std::uint32_t decide();

  LocalizerConfig config_;
  StoredMapMatching matching_;
  PlaceSearch search_;
  StateMonitor monitor_;
  ContinuedPlace continued_;
  DriveAgreement agreement_;  // of the stops that are tracked
  UncertainPose pose_;        // T_map_robot at the last stop
  bool has_pose_ = false;
  bool monitored_ = false;                      // the last stop was, by what its pose is judged
  bool pose_is_given_ = false;                  // since the last stop
  std::optional<geometry::Pose2> T_odom_last_;  // nothing before the first stop
  std::optional<std::uint64_t> last_epoch_;     // of T_odom_last_, if it is known
  std::vector<LocalizedStop> stops_;
  std::uint32_t added_ = 0;           // stops that came
  std::uint64_t numbered_since_ = 0;  // of them, when some were forgotten last
  std::array<std::uint64_t, kLocalizationStates> stops_by_state_{};
  std::optional<TrackedStep> last_step_;
  LocalizationStatus status_;
  std::size_t searches_ = 0;
  std::optional<topomap::StopId> last_id_;  // of the last stop
  std::uint64_t steps_in_doubt_ = 0;
};

}  // namespace topogeo::localization
