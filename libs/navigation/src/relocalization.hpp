// A robot without a pose stands for a while and then, where it may, moves so that the localizer
// finds out where it is.
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
  /// `farthest_m`: how far it may go without a pose; 0: it stands.
  explicit Relocalization(double farthest_m) : farthest_m_(farthest_m), look_around_(farthest_m) {}

  /// The pose has been lost.
  void begin(std::int64_t now_ns);

  struct Lost {
    std::string why;               ///< there is no pose, for people
    bool may_look_around = false;  ///< the goal allows it
    /// There is a pose, but the localizer is not sure of it.
    bool doubtful = false;
    std::optional<geometry::Pose2> T_odom_robot;
  };
  struct Step {
    std::optional<geometry::Velocity> wanted;  ///< not judged by the guard yet; nothing: it stands
    std::string message;                       ///< one line for people
  };
  Step step(const Lost& lost, const CollisionGuard& guard, std::int64_t now_ns);

 private:
  double farthest_m_;
  LookAround look_around_;
  std::int64_t lost_ns_ = 0;
};

}  // namespace topogeo::navigation
