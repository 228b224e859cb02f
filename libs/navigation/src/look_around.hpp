// Moves that let a localizer find an unknown pose: a full turn on the spot, a short distance
// towards the most room, and so on. A base that cannot turn on the spot turns on arcs, ahead and
// back by turns where there is no room for a circle, and goes on straight ahead.
#pragma once

#include <cstdint>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"

namespace topogeo::navigation {

class LookAround {
 public:
  explicit LookAround(double farthest_m, double minimum_radius_m = 0.0)
      : farthest_m_(farthest_m), minimum_radius_m_(minimum_radius_m) {}

  void reset() { *this = LookAround(farthest_m_, minimum_radius_m_); }

  /// The next velocity, not yet checked by the guard.
  geometry::Velocity step(const geometry::Pose2& T_odom_robot, const CollisionGuard& guard,
                          std::int64_t now_ns);

  /// It has gone its full distance and has turned round there.
  [[nodiscard]] bool finished() const { return phase_ == Phase::kFinished; }
  /// It has completed its first full turn, or has no room for it.
  [[nodiscard]] bool been_round() const { return been_round_; }
  [[nodiscard]] double gone_m() const { return gone_m_; }

 private:
  enum class Phase { kRound, kFace, kGo, kFinished };
  geometry::Velocity round(const geometry::Pose2& T_odom_robot, double free_m);
  /// The same turn on arcs.
  geometry::Velocity round_on_arcs(const CollisionGuard& guard, std::int64_t now_ns);
  geometry::Velocity face(const geometry::Pose2& T_odom_robot);
  geometry::Velocity go(double free_m);

  double farthest_m_;
  double minimum_radius_m_;
  double ahead_ = 1.0;  ///< of arcs; -1: back
  bool been_round_ = false;
  Phase phase_ = Phase::kRound;
  std::optional<geometry::Pose2> T_odom_last_;
  double turned_rad_ = 0.0;
  double gone_m_ = 0.0;
  double leg_m_ = 0.0;
  double best_free_m_ = 0.0;
  double best_heading_rad_ = 0.0;
};

}  // namespace topogeo::navigation
