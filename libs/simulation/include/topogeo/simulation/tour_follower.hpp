// Pure pursuit: follows a path by a target point that moves ahead of the robot on it, slows down
// for turns and obstacles, and turns on the spot where the path folds back.
#pragma once

#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"

namespace topogeo::simulation {

using geometry::Velocity;  ///< commands of a base

struct DriveOptions {
  double speed_m_per_s = 0.9;                               ///< at most; (0, 10]
  double turn_rad_per_s = 60.0 * std::numbers::pi / 180.0;  ///< at most; (0, 10]
  double acceleration_m_per_s2 = 0.5;                       ///< (0, 10]
  double lookahead_m = 0.4;  ///< distance of the target point; corners are cut by less; [0.05, 5]
  /// Rate of turning per heading error; (0, 10]. Lower for a base that obeys late: above half of
  /// the delay's inverse it oscillates about its path.
  double turn_gain_per_s = 3.0;
  double keep_off_m = 0.1;  ///< from obstacles ahead, if given to next(); [0, 5]
};

class TourFollower {
 public:
  /// Throws std::invalid_argument if an option is out of range or there are fewer than two
  /// different waypoints in succession.
  TourFollower(const std::vector<Eigen::Vector2d>& tour_m, const DriveOptions& options);

  /// The pose at the first waypoint, heading for the second.
  [[nodiscard]] geometry::Pose2 start() const;

  /// The velocity for the next `dt_s` (> 0) at this pose; nothing at the end. The speed grows with
  /// the acceleration of the options but falls at once, because braking on a curve would carry the
  /// robot off the path. `free_ahead_m`: free distance straight ahead. The robot slows down in time
  /// to stop keep_off_m before its end, and waits there.
  std::optional<Velocity> next(const geometry::Pose2& T_world_robot, double dt_s,
                               double free_ahead_m = std::numeric_limits<double>::infinity());

  /// Length of the path from the target point to the end.
  [[nodiscard]] double rest_m() const;

 private:
  // Advances the target point.
  void run_ahead(const Eigen::Vector2d& robot_m);
  [[nodiscard]] Eigen::Vector2d ahead_m() const;
  [[nodiscard]] bool ahead_at_end() const { return next_ == path_m_.size(); }

  DriveOptions options_;
  std::vector<Eigen::Vector2d> path_m_;
  std::size_t next_ = 1;  // the target point is on the line from path_m_[next_ - 1] to this one
  double along_m_ = 0.0;  // on that line
  double rest_m_ = 0.0;
  double speed_m_per_s_ = 0.0;
};

}  // namespace topogeo::simulation
