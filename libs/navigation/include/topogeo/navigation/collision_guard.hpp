// Keeps a robot from driving into what its laser and sonars see, whatever it is told by whoever
// plans its way (spec B4). It knows no map, no pose and no route.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct GuardConfig {
  double radius_m = 0.267;             ///< of the robot's round body, [0.05, 2]
  double margin_m = 0.05;              ///< nothing comes nearer to the body while it drives, [0, 1]
  double deceleration_m_per_s2 = 0.5;  ///< that the base surely can, [0.05, 10]
  double delay_s = 0.25;               ///< from a measurement until the base obeys, [0, 2]
  double oldest_scan_s = 0.6;          ///< an older scan is none, [0.05, 10]
  bool needs_scan = true;              ///< no motion without one; false: sonars are enough
  bool needs_sonar = false;            ///< no motion without sonars
  double sonar_reach_m = 1.5;  ///< sonars must hear what the laser sees nearer than this in their
                               ///< cone, [0.2, 5]
  double silent_s = 1.0;       ///< that long without any echo where there must be one, and the
                               ///< sonars count as silent, [0.1, 60]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const GuardConfig& config);

struct GuardVerdict {
  geometry::Velocity allowed;             ///< the wanted motion, slower or none
  HaltReason reason = HaltReason::kNone;  ///< why nothing is allowed at all
  std::string message;                    ///< for people; empty when the motion is allowed
  double free_way_m = 0.0;  ///< along the wanted motion before the body touches something; <= 5
  bool limited = false;     ///< slower than wanted
};

class CollisionGuard {
 public:
  /// Throws std::invalid_argument as `check`.
  explicit CollisionGuard(const GuardConfig& config);

  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);

  /// What of a wanted velocity is safe now. Turning on the spot of a round body always is, as long
  /// as the sensors work.
  [[nodiscard]] GuardVerdict judge(const geometry::Velocity& wanted, std::int64_t now_ns) const;

 private:
  GuardConfig config_;
};

}  // namespace topogeo::navigation
