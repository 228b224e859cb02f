// The pose of a robot on a known map by Markov localization (MACONDO, III.1; docs/algorithms.md,
// "Markov localization"): carried on by odometry, corrected by sonars or a laser at stops of the
// robot.
//
// Executed motion is passed on as the primitives between two stops, as odometry measured them:
// turn, advance, turn. The axes of the window are those of the map's grid, which may be rotated in
// the map frame.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/markov/markov_localizer.hpp"
#include "topogeo/markov/pose_localizer.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::navigation {

/// Beams of a scan as range readings, one every `step_rad` (> 0) from -90 to 90 degrees of the
/// laser; scan::Scan::kNoReturn if no point lies on a beam.
SonarRound laser_round(const ScanPoints& scan, double step_rad);

class MarkovTracker {
 public:
  /// Occupied and unknown cells are obstacles. Throws std::invalid_argument like `check`.
  MarkovTracker(const planning::OccupancyGrid& grid, const MarkovTrackerConfig& config = {});

  /// The robot stands at the base station and measures these readings there. All later rounds have
  /// the same sensors. False, with `reason()`, if the station is not a free cell. Throws
  /// std::invalid_argument for invalid readings and mounts.
  bool start(const geometry::Pose2& T_map_base_station, const SonarRound& readings);
  [[nodiscard]] bool started() const { return localizer_.has_value() || poses_ != nullptr; }

  void add(const OdometrySample& sample);

  /// A primitive has been executed, or a sufficient part of the path: the belief follows the
  /// odometry.
  void primitive_done();
  /// The robot stands at a border node or at the end of its route and measures these readings.
  /// Follows the motion since the last primitive first. Throws std::runtime_error before start(),
  /// std::invalid_argument for another number of sensors.
  markov::PerceptionReport perceive(const SonarRound& readings);
  /// The same while driving: a grid of poses uses a round if the robot has moved far enough since
  /// the last one; a grid of positions ignores it. A round that is newer than the odometry waits
  /// for it.
  void hear(const SonarRound& readings);

  /// The current pose; tracking as long as some cell is possible. Nothing before start() and
  /// without odometry.
  [[nodiscard]] std::optional<PoseFix> fix() const;
  /// Correction by the last perceive(), metres.
  [[nodiscard]] double corrected_m() const { return corrected_m_; }
  /// The moves from the current pose to a pose of the route (map frame), straight: turn, advance,
  /// turn. Nothing with a grid of poses.
  [[nodiscard]] std::optional<markov::ReturnMoves> return_moves(
      const geometry::Pose2& T_map_route) const;
  /// The reason for a missing pose; empty if there is a pose.
  [[nodiscard]] const std::string& reason() const { return reason_; }

 private:
  void follow(const markov::Move& move);
  void follow_poses(const geometry::Pose2& T_odom_robot);
  void hear_waiting();
  markov::PerceptionReport perceive_poses(const SonarRound& readings);
  [[nodiscard]] PoseFix pose_fix() const;

  MarkovTrackerConfig config_;
  markov::ObstacleCells cells_;
  geometry::Pose2 T_map_grid_;
  std::optional<markov::MarkovLocalizer> localizer_;
  std::unique_ptr<markov::PoseLocalizer> poses_;
  geometry::OdometryTrack track_{0};
  std::optional<SonarRound> waiting_;  ///< newer than the odometry
  geometry::Pose2 T_odom_heard_;       ///< at the last round of sonars
  std::optional<OdometrySample> last_;
  geometry::Pose2 T_odom_followed_;  ///< the belief has followed up to here
  double corrected_m_ = 0.0;
  std::string reason_ = "not started";
};

}  // namespace topogeo::navigation
