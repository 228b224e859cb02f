// Markov localization over positions and headings on a known grid, while the robot drives (Dieter
// Fox, Wolfram Burgard and Sebastian Thrun: Markov Localization for Mobile Robots in Dynamic
// Environments, Journal of Artificial Intelligence Research 11, 1999; docs/algorithms.md, "Markov
// localization").
//
// MACONDO's window lacks what wheels and sonars need: here the heading is estimated, each reading
// multiplies the belief by its own probability (of the expected obstacle, of a nearer one that is
// not on the map, or of any distance), and sonars are used every decimetre and not only at nodes.
// The window contains errors of odometry, so motion itself does not blur it.
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
  /// Starts at the base station of the robot. Throws std::invalid_argument for settings or sensors
  /// out of range. `max_range_m`: range of the sensors, beyond which they detect nothing.
  PoseLocalizer(const PoseGridConfig& config, ObstacleCells map, std::vector<RangeSensor> sensors,
                double max_range_m, const geometry::Pose2& T_map_station);
  PoseLocalizer(const PoseLocalizer&) = delete;
  PoseLocalizer& operator=(const PoseLocalizer&) = delete;

  /// The robot has moved by this, by its odometry (robot frame).
  void move(const geometry::Pose2& T_robot_then_now);

  /// Uses the current readings of the sensors; metres, scan::Scan::kNoReturn for none. Throws
  /// std::invalid_argument for another number of readings or an invalid one.
  void perceive(std::span<const float> ranges_m);

  /// Smoothed share of readings up to far_from_m that agree with the map at the estimated pose, [0,
  /// 1]; 1 before the first reading.
  [[nodiscard]] double agreement() const { return agreement_; }
  /// False if the readings have not agreed with the map for long, or no free cell is possible: then
  /// the whole window is possible again.
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
  std::vector<ConeRanges> cones_;     ///< one per opening angle
  std::vector<std::size_t> cone_of_;  ///< by sensor
  PoseGrid grid_;
  geometry::Pose2 T_map_expected_;
  PoseEstimate estimate_;
  double agreement_ = 1.0;
  std::string reason_;
};

}  // namespace topogeo::markov
