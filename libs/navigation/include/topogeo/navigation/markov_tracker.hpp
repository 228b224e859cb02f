// The pose of a robot on a known map by Markov localization (MACONDO, III.1; docs/algorithms.md,
// "Markov localization"): carried on by odometry, corrected by what sonars or a laser measure where
// the robot stops to look.
//
// Executed motion is handed on as the primitives that lead from one stop to the next as odometry
// saw it: turn, advance, turn. The axes of the window are those of the map's grid, which may be
// turned in the map frame.
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
/// laser; scan::Scan::kNoReturn where no point lies on a beam.
SonarRound laser_round(const ScanPoints& scan, double step_rad);

class MarkovTracker {
 public:
  /// Occupied and unknown cells are obstacles. Throws std::invalid_argument as `check`.
  MarkovTracker(const planning::OccupancyGrid& grid, const MarkovTrackerConfig& config = {});

  /// The robot stands at the base station and measures this there. Its sensors are those of all
  /// rounds to come. False, with `reason()`, when the station is no free cell. Throws
  /// std::invalid_argument for readings and mounts that are not valid.
  bool start(const geometry::Pose2& T_map_base_station, const SonarRound& readings);
  [[nodiscard]] bool started() const { return localizer_.has_value() || poses_ != nullptr; }

  void add(const OdometrySample& sample);

  /// A primitive has been executed, or a part of the path that is long enough: the belief
  /// follows the odometry.
  void primitive_done();
  /// The robot stands at a border node or at the end of its route and measures this. Follows
  /// the motion since the last primitive first. Throws std::runtime_error before start(),
  /// std::invalid_argument for another number of sensors.
  markov::PerceptionReport perceive(const SonarRound& readings);
  /// The same while it drives: with a grid of poses, once it has moved far enough since the last
  /// readings; does nothing with one of positions. A round that is newer than the odometry waits
  /// for it.
  void hear(const SonarRound& readings);

  /// Where the robot is now; tracking as long as some cell is possible. Nothing before start() and
  /// without odometry.
  [[nodiscard]] std::optional<PoseFix> fix() const;
  /// How far the last perceive() moved the robot from where it was expected, metres.
  [[nodiscard]] double corrected_m() const { return corrected_m_; }
  /// The moves from where it is to a pose of the route (map frame), straight: turn, advance, turn.
  /// Nothing with a grid of poses.
  [[nodiscard]] std::optional<markov::ReturnMoves> return_moves(
      const geometry::Pose2& T_map_route) const;
  /// Why there is no pose; empty when there is one.
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
  geometry::Pose2 T_odom_heard_;       ///< where sonars were heard last
  std::optional<OdometrySample> last_;
  geometry::Pose2 T_odom_followed_;  ///< up to where the belief has followed
  double corrected_m_ = 0.0;
  std::string reason_ = "not started";
};

}  // namespace topogeo::navigation
