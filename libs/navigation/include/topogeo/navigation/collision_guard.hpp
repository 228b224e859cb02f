// Prevents a robot from driving into anything that its laser and sonars see, whatever its path
// planner wants. It has no map, no pose and no route (MACONDO, I and III; docs/algorithms.md,
// "Driving and collision guard"). Drawn walls and no-go zones are points that its owner puts around
// the robot while the pose is known.
//
// The obstacles are the points of the last scan, carried on by odometry, and the echoes of the
// sonars if the laser sees nothing in their cone. The body's disc must not touch them on the wanted
// arc nor on the present one. The free distance limits the speed to one from which the robot still
// stops in time in any case: the age of its data, its delay and the time that the base runs on
// without its gateway count (geometry/reaction_times.hpp). Laser noise is smoothed over
// neighbouring beams by at most the side margin, so a measured point itself is never touched. A
// body that is not round counts with its outline, also while it turns (outline_sweep.hpp).
//
// The fields that the laser itself watches are a second line of defence, independent of odometry,
// body and mounting (Thesis, appendix B.1).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/navigation/guard_inputs.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct GuardVerdict {
  geometry::Velocity allowed;             ///< the wanted motion, slower on the same arc, or none
  HaltReason reason = HaltReason::kNone;  ///< why no motion at all is allowed
  std::string message;                    ///< for people; empty when the motion is allowed
  double free_m = 0.0;   ///< along the wanted motion before the body touches anything; <= 5
  bool limited = false;  ///< slower than wanted
  /// The obstacle at the end of the free distance, robot frame; nothing if there is none within 5
  /// m, or only a drawn one.
  std::optional<Eigen::Vector2d> contact_m;
};

class CollisionGuard {
 public:
  static constexpr double kFarthest_m = 5.0;

  /// Throws std::invalid_argument like `check`.
  explicit CollisionGuard(const GuardConfig& config);

  // The overloads do what those of GuardInputs do.
  void add(const OdometrySample& odometry) { inputs_.add(odometry); }
  void add(const ScanPoints& scan) { inputs_.add(scan); }
  void add(const SonarRound& sonar) { inputs_.add(sonar); }
  void add(const LaserFields& fields);
  void keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
    inputs_.keep_off(stamp_ns, std::move(points_m));
  }

  /// Returns the safe part of a wanted velocity, with no tighter turn than the base can drive. A
  /// round body may always turn on the spot while the sensors work, if the base can, and another
  /// one only where its corners touch nothing. It moves backwards only with fresh sonars.
  [[nodiscard]] GuardVerdict judge(const geometry::Velocity& wanted, std::int64_t now_ns) const;

  /// Why no motion at all is allowed; kNone when the sensors work. `message` may be null.
  [[nodiscard]] HaltReason health(std::int64_t now_ns, std::string* message = nullptr) const {
    return inputs_.health(now_ns, message);
  }

 private:
  /// s; from the measurement until the base surely brakes.
  [[nodiscard]] double reaction_s(std::int64_t now_ns) const;
  /// m/s; the speed from which it stops within a free distance.
  [[nodiscard]] double speed_for(double free_m, double reaction_s) const;
  /// Reduces a verdict by the fields of the laser.
  void obey_fields(GuardVerdict& verdict) const;
  [[nodiscard]] GuardVerdict judge_by_distances(const geometry::Velocity& wanted,
                                                std::int64_t now_ns) const;

  GuardConfig config_;
  GuardInputs inputs_;
  std::optional<LaserFields> fields_;
};

}  // namespace topogeo::navigation
