// Markov localization as a navigator's source of poses: times of looks, and their readings.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/markov_tracker.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

class MarkovMode {
 public:
  explicit MarkovMode(const NavigatorConfig& config) : config_(config) {}

  [[nodiscard]] bool on() const { return config_.pose_source == PoseSource::kMarkov; }

  /// Continues at its pose in the new map.
  void set_map(const planning::HybridMap* map);
  void add(const PoseFix& base_station);
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);

  /// Starts once all inputs are there; returns the current pose for the navigator.
  std::optional<PoseFix> pose();
  void primitive_done();

  /// Sets the places along a path where the robot has to look, its border nodes.
  void set_path(std::span<const planning::PathSample> path,
                std::span<const Eigen::Vector2d> nodes_m);
  /// True once for each node that the robot reaches.
  bool comes_to_node(double progress_m);

  void begin_look(std::int64_t now_ns) { look_ns_ = now_ns; }
  [[nodiscard]] bool looks() const { return look_ns_.has_value(); }
  /// If a look is due, performs it as soon as a reading has come since the robot stands; returns
  /// the correction of the pose, metres. Nothing before.
  std::optional<double> look(std::int64_t now_ns);

 private:
  void hear(const SonarRound& round);

  const NavigatorConfig& config_;
  std::optional<MarkovTracker> tracker_;
  std::optional<geometry::Pose2> T_map_station_;
  std::optional<OdometrySample> odometry_;
  std::optional<SonarRound> round_;
  std::optional<std::int64_t> tried_ns_;  ///< stamp of the round that failed to start it
  std::optional<std::int64_t> look_ns_;
  std::vector<double> nodes_at_m_;
  std::size_t next_node_ = 0;
};

}  // namespace topogeo::navigation
