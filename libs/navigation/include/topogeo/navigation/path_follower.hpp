// Drives a base along a sampled path: leg by leg, each beginning with a turn on the spot if needed
// and ending with a stop.
//
// On a leg the curvature of the motion is that of the path, corrected for the distance from it and
// the heading error so that both vanish over a distance of `kSettle_m`, at any speed. All control
// uses the pose at which the base will obey (command_history.hpp). Paths of smooth_path() have few
// legs; paths of straight_path() have one for every advance primitive, so that these are executed
// one after the other. A base with a smallest turning radius begins each leg as it stands, and gets
// no final turn: its paths end in the wanted heading.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/command_history.hpp"
#include "topogeo/navigation/follower_config.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

/// The samples of a polyline with a turn on the spot at every corner.
std::vector<planning::PathSample> straight_path(std::span<const Eigen::Vector2d> points_m,
                                                double step_m = 0.1);

struct FollowerStep {
  geometry::Velocity command;
  bool done = false;     ///< stands at the end of the path, in its final heading
  bool strayed = false;  ///< a base that cannot turn on the spot does not get back to the path
  double rest_m = 0.0;   ///< of the path
  double rest_s = 0.0;   ///< approximately
  double off_m = 0.0;    ///< distance from the path
};

class PathFollower {
 public:
  static constexpr double kSettle_m = 0.35;

  /// Throws std::invalid_argument like `check`.
  explicit PathFollower(const FollowerConfig& config);

  /// Switches to another path, even while moving. With an empty `path` there is only the final
  /// heading to turn to. `limits_m_per_s`: speed limits at the samples, for the estimate of the
  /// time; empty: none.
  void follow(std::vector<planning::PathSample> path, std::optional<double> final_heading_rad,
              std::span<const double> limits_m_per_s = {});
  void forget();
  [[nodiscard]] bool has_path() const { return active_; }

  /// The command for the pose now. `speed_limit_m_per_s` >= 0 for this step. `now_ns` never goes
  /// back.
  FollowerStep step(const geometry::Pose2& T_map_robot, std::int64_t now_ns,
                    double speed_limit_m_per_s);

  /// The command that the base really got at that time; call once per step, even without a path.
  void commanded(const geometry::Velocity& command, std::int64_t now_ns);

  [[nodiscard]] std::span<const planning::PathSample> path() const { return path_; }
  [[nodiscard]] double progress_m() const { return progress_m_; }
  [[nodiscard]] double rest_m() const;

  /// Primitives of the path executed since the last call: turns on the spot and legs. Drops those
  /// of the previous path.
  std::vector<planning::MotionPrimitive> take_finished();

 private:
  enum class Phase : std::uint8_t { kTurn, kAdvance, kFinalTurn, kDone };
  struct Place {
    Eigen::Vector2d position_m;
    double heading_rad;
    double curvature_per_m;
    double left_m;  ///< of the path, from the robot on
    double to_go_m;
  };

  [[nodiscard]] double rest_s() const;
  [[nodiscard]] std::size_t leg_end(std::size_t from) const;
  [[nodiscard]] Place locate(const geometry::Pose2& T_map_robot);
  [[nodiscard]] bool steers() const { return config_.minimum_radius_m > 0.0; }
  /// Curvature that a base that steers follows: the change to another takes it some distance.
  [[nodiscard]] double mean_curvature_per_m() const;
  /// The speed at which it can change the curvature within that distance.
  [[nodiscard]] double steering_speed() const;
  [[nodiscard]] double curve_speed(double to_go_m) const;
  [[nodiscard]] geometry::Velocity turn(double error_rad) const;
  [[nodiscard]] geometry::Velocity advance(const geometry::Pose2& T_map_robot, const Place& place,
                                           double limit_m_per_s) const;
  [[nodiscard]] bool backs_up() const;
  geometry::Velocity control_either_way(const geometry::Pose2& T_map_robot, double limit_m_per_s);
  geometry::Velocity control(const geometry::Pose2& T_map_robot, double limit_m_per_s);
  [[nodiscard]] geometry::Velocity ramped(const geometry::Velocity& wanted,
                                          std::int64_t now_ns) const;
  void begin_leg(std::size_t from);
  void finish_turn(double heading_rad);
  void finish_leg(const Eigen::Vector2d& at_m);

  FollowerConfig config_;
  std::vector<planning::PathSample> path_;
  std::vector<double> rest_times_s_;  // from each sample to the end
  std::optional<double> final_heading_rad_;
  bool active_ = false;
  Phase phase_ = Phase::kDone;
  std::size_t leg_begin_ = 0;
  std::size_t leg_end_ = 0;
  std::size_t segment_ = 0;  ///< of the path, containing the robot
  double progress_m_ = 0.0;
  double off_m_ = 0.0;
  bool strayed_ = false;

  CommandHistory commands_;

  std::optional<double> turn_from_rad_;
  std::optional<Eigen::Vector2d> leg_from_m_;
  std::vector<planning::MotionPrimitive> finished_;
};

}  // namespace topogeo::navigation
