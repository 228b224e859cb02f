// Behaviour without a pose: the robot stands for a while and then, if allowed, moves so that the
// localizer can find its pose.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"

#include "look_around.hpp"

namespace topogeo::navigation {

class Relocalization {
 public:
  /// `farthest_m`: largest distance without a pose; 0: it stands. `minimum_radius_m`: of the base,
  /// which turns on the spot for 0.
  explicit Relocalization(double farthest_m, double minimum_radius_m = 0.0)
      : farthest_m_(farthest_m), look_around_(farthest_m, minimum_radius_m) {}

  /// The pose has been lost.
  void begin(std::int64_t now_ns);

  struct Lost {
    std::string why;               ///< reason for the missing pose, for people
    bool may_look_around = false;  ///< the goal allows it
    /// There is a pose of which the localizer is not certain.
    bool doubtful = false;
    std::optional<geometry::Pose2> T_odom_robot;
  };
  struct Step {
    std::optional<geometry::Velocity> wanted;  ///< not yet checked by the guard; nothing: it stands
    std::string message;                       ///< one line for people
  };
  Step step(const Lost& lost, const CollisionGuard& guard, std::int64_t now_ns);

 private:
  double farthest_m_;
  LookAround look_around_;
  std::int64_t lost_ns_ = 0;
};

}  // namespace topogeo::navigation
