// Markov localization over positions and headings on a known grid, while the robot drives (Dieter
// Fox, Wolfram Burgard and Sebastian Thrun: Markov Localization for Mobile Robots in Dynamic
// Environments, Journal of Artificial Intelligence Research 11, 1999; docs/algorithms.md, "Markov
// localization").
//
// What MACONDO's window leaves out and wheels and sonars need: the heading is estimated, each
// reading multiplies the belief by its own probability (of what is expected, of something nearer
// that is not on the map, or of anything), and sonars are heard every decimetre and not at nodes
// alone. The window holds errors of odometry, so motion itself does not blur it.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/markov/cone_ranges.hpp"
#include "topogeo/markov/markov_config.hpp"
#include "topogeo/markov/obstacle_cells.hpp"
#include "topogeo/markov/pose_grid.hpp"
#include "topogeo/markov/range_sensor.hpp"

namespace topogeo::markov {

/// A pose with its covariance (x, y, heading; map frame).
struct PoseEstimate {
  geometry::Pose2 T_map_robot;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

class PoseLocalizer {
 public:
  /// The robot stands at its base station. Throws std::invalid_argument for settings or sensors
  /// out of range. `max_range_m`: of the sensors, beyond it they hear nothing.
  PoseLocalizer(const PoseGridConfig& config, ObstacleCells map, std::vector<RangeSensor> sensors,
                double max_range_m, const geometry::Pose2& T_map_station);
  PoseLocalizer(const PoseLocalizer&) = delete;
  PoseLocalizer& operator=(const PoseLocalizer&) = delete;

  /// It has moved by this, by its odometry (robot frame).
  void move(const geometry::Pose2& T_robot_then_now);

  /// What the sensors read here; metres, scan::Scan::kNoReturn for none. Throws
  /// std::invalid_argument for another number of readings or a bad one.
  void perceive(std::span<const float> ranges_m);

  /// Smoothed share of readings up to far_from_m that agree with what the map has at the estimated
  /// pose, [0, 1]; 1 before there was one.
  [[nodiscard]] double agreement() const { return agreement_; }
  /// False when the readings have not agreed with the map for long, or no free cell is possible:
  /// then the whole window is possible again.
  [[nodiscard]] bool located() const { return reason_.empty(); }
  [[nodiscard]] const std::string& reason() const { return reason_; }
  [[nodiscard]] const PoseEstimate& estimate() const { return estimate_; }
  [[nodiscard]] const PoseGrid& grid() const { return grid_; }

 private:
  void weigh(std::span<const float> ranges_m);
  void keep_free_cells();
  void update_estimate();
  void watch_agreement(std::span<const float> ranges_m);
  void make_log_table(double reading_m, std::vector<float>& table) const;

  PoseGridConfig config_;
  ObstacleCells map_;
  std::vector<RangeSensor> sensors_;
  double max_range_m_;
  std::vector<ConeRanges> cones_;     ///< one for each opening angle
  std::vector<std::size_t> cone_of_;  ///< by sensor
  PoseGrid grid_;
  geometry::Pose2 T_map_expected_;
  PoseEstimate estimate_;
  double agreement_ = 1.0;
  std::string reason_;
};

}  // namespace topogeo::markov
