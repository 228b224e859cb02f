// Localizes a robot in a finished map that does not change (docs/algorithms.md, "Localization in a
// finished map"): every stop of the drive is matched with the stored stops that should look alike
// from its pose by odometry.
//
// Matches between stops of the drive only improve the odometry, so errors do not grow along the
// path. If the state monitor reports that the robot is lost, and at a start without a pose, every
// stop is searched in the whole map (PlaceSearch). All matching goes through the pool, and the
// result does not depend on who answered or when.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/slam/slam.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/slam/stored_map.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/trajectory.hpp"

namespace topogeo::localization {

/// The state at one stop of the drive.
struct LocalizedStop {
  topomap::StopId stop;
  std::int64_t stamp_ns = 0;
  geometry::Pose2 T_map_robot;                           ///< meaningless when searching or lost
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< in the map frame
  LocalizationStatus status;
  std::uint32_t accepted_matches = 0;
};

/// Evidence of a tracked stop.
struct TrackedStep {
  UncertainPose predicted;  ///< T_map_robot by odometry from the previous stop
  StepEvidence evidence;
  std::vector<geometry::Pose2> measured;  ///< T_map_robot by each of the matches
  std::vector<StoredMatch> accepted;      ///< the accepted ones
  /// T_stop_robot of the accepted matches by the scans alone, without the prediction: for a pose
  /// graph, which uses the prediction as a measurement of its own.
  std::vector<UncertainPose> scans_alone;
};

/// Pose of a robot at the last stop of its drive.
struct LastPlace {
  UncertainPose T_map_robot;
  geometry::Pose2 T_odom_robot;
  std::uint64_t odometry_epoch = 0;  ///< as in scan::Scan
};

struct DriveStop;
struct MatchCandidate;

class MapTracker : public Slam {
 public:
  /// Starts without a pose. The pool must outlive this. Throws like GlobalLocalizer.
  MapTracker(const LocalizerConfig& config, std::shared_ptr<const StoredMap> map, MatchPool& pool);
  ~MapTracker() override;

  /// Adds the next stop of the drive. The numbers of a session must be consecutive from its first
  /// stop; throws std::invalid_argument otherwise. Another session continues where the previous one
  /// ended if its odometry has the same epoch (not 0) or the pose was set since. Otherwise it is
  /// another drive, whose pose is searched. In the pool and in tasks the map has one of the ids
  /// after those of the stored maps. Returns false, because no earlier pose moves.
  bool add(std::shared_ptr<const topomap::LocalMap> map) override;
  /// Does nothing: no work is left after the last map.
  void finish() override {}

  /// Sets the pose of the robot at its last stop or, before the first one, at that. Ends a search.
  void set_pose(const geometry::Pose2& T_map_robot, const Eigen::Matrix3d& covariance);

  /// The robot continues from an own stop outside this drive: the last one of the map, if that was
  /// just made. Call before the first stop.
  void start_after(const topomap::LocalMap& map, const geometry::Pose2& T_map_robot);
  /// The same for a previous drive. A first stop with another odometry epoch is searched.
  void start_after(const LastPlace& place);

  /// Continues the numbering of tasks there; no number may occur twice in one pool.
  void number_tasks_from(std::uint64_t next_task);
  [[nodiscard]] std::uint64_t next_task() const;

  /// Forgets the pose and searches the whole map, starting with the next stop.
  void search();

  /// Forgets old stops but keeps at least the `most` last ones. The others get new numbers in the
  /// trajectory.
  void forget_stops(std::size_t most);

  /// Number of received stops, including forgotten ones.
  [[nodiscard]] std::uint32_t added_stops() const { return added_; }
  /// All stops that were not forgotten.
  [[nodiscard]] const std::vector<LocalizedStop>& stops() const { return stops_; }
  /// stops() as a trajectory in the frame of the map.
  [[nodiscard]] topomap::Trajectory trajectory() const override;
  [[nodiscard]] std::optional<topomap::StopPose> last_stop() const override;
  /// Empty: the map does not change.
  [[nodiscard]] std::vector<topomap::LoopClosure> loop_closures() const override { return {}; }
  /// Empty.
  [[nodiscard]] const std::vector<LoopDecision>& loop_decisions() const override {
    return no_decisions();
  }
  [[nodiscard]] LocalizationStatus status() const override { return status_; }
  [[nodiscard]] SlamCounts counts() const override;
  /// Number of all stops by state, including forgotten ones.
  [[nodiscard]] const std::array<std::uint64_t, kLocalizationStates>& stops_by_state() const {
    return stops_by_state_;
  }
  /// Evidence of the last stop; empty if that was searched.
  [[nodiscard]] const std::optional<TrackedStep>& last_step() const { return last_step_; }
  [[nodiscard]] std::size_t searches() const { return searches_; }
  /// Id in the finished map after which the maps of the drive are numbered: the number of stored
  /// maps.
  [[nodiscard]] std::uint32_t first_id() const { return first_id_; }

 private:
  void begin_session(std::uint64_t odometry_epoch);
  std::uint32_t track(const DriveStop& stop);
  std::vector<MatchTask> tracking_tasks(const DriveStop& stop,
                                        std::span<const MatchCandidate> stored);
  std::vector<bool> agreeing(std::span<const MatchTask> tasks, std::span<const MatchResult> results,
                             std::span<const UncertainPose> measured);
  [[nodiscard]] double better_elsewhere(const DriveStop& stop) const;
  void compare_continued(const DriveStop& stop);
  void begin_search();
  void look_around(const DriveStop& stop);
  void match_hypotheses(const DriveStop& stop);
  std::uint32_t decide();

  LocalizerConfig config_;
  std::uint32_t first_id_;
  struct Parts;
  std::unique_ptr<Parts> parts_;
  StateMonitor monitor_;
  UncertainPose pose_;  // T_map_robot at the last stop
  bool has_pose_ = false;
  bool monitored_ = false;                      // monitor_ has judged the last stop
  bool pose_is_given_ = false;                  // since the last stop
  std::optional<geometry::Pose2> T_odom_last_;  // empty before the first stop
  std::optional<std::uint64_t> last_epoch_;     // of T_odom_last_, if known
  std::vector<LocalizedStop> stops_;
  std::uint32_t added_ = 0;           // number of received stops
  std::uint64_t numbered_since_ = 0;  // added_ when stops were last forgotten
  std::array<std::uint64_t, kLocalizationStates> stops_by_state_{};
  std::optional<TrackedStep> last_step_;
  LocalizationStatus status_;
  std::size_t searches_ = 0;
  std::optional<topomap::StopId> last_id_;  // of the last stop
  std::uint64_t steps_in_doubt_ = 0;
};

/// Current T_map_robot: the pose of the last stop, then the relative pose of the newest scan that
/// was matched with the scan of that stop, then the odometry since. Without such a scan (`tracked`
/// null, or not matched) only the odometry since the stop. `T_odom_stop`: the odometry at the stop.
UncertainPose live_pose(const UncertainPose& T_map_stop, const geometry::Pose2& T_odom_stop,
                        const topomap::TrackedScan* tracked, const geometry::Pose2& T_odom_robot,
                        const OdometryNoise& noise);

}  // namespace topogeo::localization
