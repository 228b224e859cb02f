// Final check of motion: whatever any program commands, the base stops before obstacles that the
// laser sees. It runs beside the driver of the base, and checks the current command repeatedly.
//
// The collision guard of a well-behaved program keeps a larger distance and brakes earlier. This
// guard has the body without margins and the shorter delay of the gateway, so that the two never
// conflict. Its view is that of the laser, which does not look backwards (docs/algorithms.md,
// "Driving and collision guard").
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

class LastGuard {
 public:
  /// Callers must judge this often while a command holds, and at each new command.
  static constexpr std::int64_t kPeriod_ns = 50'000'000;

  /// `runs_on_s`: between the end of its program and the base's own braking, >= 0. Throws
  /// std::invalid_argument like `check`.
  LastGuard(const GuardConfig& config, double runs_on_s);

  /// Call in time order; a sample that is not newer than the previous is ignored.
  void add(const geometry::OdometrySample& odometry);
  /// Points of the laser, robot frame at `stamp_ns`. Ignores `T_odom_robot`, because the odometry
  /// of that time may still come. Points identical to the previous ones, although the robot has
  /// moved, come from a hanging laser and do not count.
  void add(const ScanPoints& scan);

  enum class Verdict : std::uint8_t {
    kAsWanted,
    kSlower,    ///< on the same arc
    kObstacle,  ///< no motion ahead or back: the laser sees something there
    kBlind      ///< no motion ahead or back: no fresh scan, or no odometry
  };
  struct Judgement {
    geometry::Velocity allowed;
    Verdict verdict = Verdict::kAsWanted;
    double free_m = 0.0;  ///< along the wanted motion before the body touches anything; <= 5
  };
  /// The part of a velocity that the base may get now, if it brakes with `brake_m_per_s2` (> 0;
  /// counted up to guard.deceleration_m_per_s2). A turn that is tighter than the base can drive is
  /// driven as tightly as it can, and none on the spot. Otherwise a round body may always turn on
  /// the spot, another one only where its corners touch nothing.
  [[nodiscard]] Judgement judge(const geometry::Velocity& asked_for, double brake_m_per_s2,
                                std::int64_t now_ns) const;

 private:
  [[nodiscard]] std::vector<Eigen::Vector2d> points_now_m() const;
  [[nodiscard]] bool sees(std::int64_t now_ns) const;
  /// Free distance of the body at a motion; of an outline, that of its farthest corner.
  [[nodiscard]] double swept_m(const geometry::Velocity& motion,
                               const std::vector<Eigen::Vector2d>& points_m) const;
  [[nodiscard]] bool repeats(const ScanPoints& scan);

  GuardConfig config_;
  double runs_on_s_;
  geometry::OdometryTrack track_;
  std::optional<geometry::OdometrySample> last_;
  std::optional<ScanPoints> scan_;       ///< smoothed
  std::vector<Eigen::Vector2d> seen_m_;  ///< of the last scan, as measured ...
  geometry::Pose2 T_odom_seen_;          ///< ... and the pose at which they first came
};

}  // namespace topogeo::navigation
