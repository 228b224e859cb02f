// Sources of poses: fixes of a localizer, or Markov localization on the map's grid; both carried on
// by odometry.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/motion_primitives.hpp"

#include "markov_mode.hpp"
#include "pose_keeper.hpp"

namespace topogeo::navigation {

class PoseSources {
 public:
  explicit PoseSources(const NavigatorConfig& config);

  void set_map(const planning::HybridMap* map) { markov_.set_map(map); }
  void add(const PoseFix& pose);
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan) { markov_.add(scan); }
  void add(const SonarRound& sonar) { markov_.add(sonar); }

  /// Call once per step. Markov localization follows the executed primitive, and looks if that is
  /// due and readings have come since the robot stands. Returns the correction of the pose by that
  /// look, metres; nothing without one.
  std::optional<double> update(bool primitive_finished, std::int64_t now_ns);

  [[nodiscard]] const PoseKeeper& keeper() const { return keeper_; }
  /// The pose at the last update(); nothing if poses come from a localizer.
  [[nodiscard]] const std::optional<PoseFix>& markov_pose() const { return markov_pose_; }
  double take_jump_m() { return keeper_.take_jump_m(); }
  double take_driven_m() { return keeper_.take_driven_m(); }

  /// The followed path and the border nodes of its route, where Markov localization looks.
  void set_path(std::span<const planning::PathSample> path,
                std::span<const Eigen::Vector2d> nodes_m);
  /// Whether the robot has to stand now so that Markov localization can look: at the end of its
  /// route, at a border node along the path, or because of an uncertain pose. `progress_m`: along
  /// the path, if one is followed.
  bool must_stand(bool at_end, std::optional<double> progress_m, std::int64_t now_ns);

 private:
  double largest_sigma_m_;
  PoseKeeper keeper_;
  MarkovMode markov_;
  std::optional<PoseFix> markov_pose_;
};

}  // namespace topogeo::navigation
