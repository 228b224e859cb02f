// The last word on motion: whatever any program commands, the base stops before what the laser
// sees. It stands beside the driver of the base, and judges the command that holds again and again.
//
// The collision guard of a program that drives well keeps further off and brakes sooner: this one
// has its body without margins and the shorter delay of the gateway, so that the two never dispute.
// It sees as far as the laser does, which is not backwards (docs/algorithms.md, "Driving and
// collision guard").
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
  /// Whoever asks must do so that often while a command holds, and at each new one.
  static constexpr std::int64_t kPeriod_ns = 50'000'000;

  /// `runs_on_s`: from the end of its program until the base brakes by itself, >= 0. Throws
  /// std::invalid_argument as `check`.
  LastGuard(const GuardConfig& config, double runs_on_s);

  /// In time order; what is not newer than the one before is left out.
  void add(const geometry::OdometrySample& odometry);
  /// What the laser sees, robot frame at `stamp_ns`. Its `T_odom_robot` is not used: the odometry
  /// of its time may still come. Points that are those of before to the last digit, though the
  /// robot has moved, come from a laser that hangs: they show nothing.
  void add(const ScanPoints& scan);

  enum class Verdict : std::uint8_t {
    kAsWanted,
    kSlower,    ///< on the same arc
    kObstacle,  ///< nothing of a motion ahead or back: the laser sees something there
    kBlind      ///< the same: there is no fresh scan, or no odometry
  };
  struct Judgement {
    geometry::Velocity allowed;
    Verdict verdict = Verdict::kAsWanted;
    double free_m = 0.0;  ///< along the wanted motion before the body touches something; <= 5
  };
  /// What of a velocity the base may get now, which brakes with `brake_m_per_s2` (> 0; counted up
  /// to guard.deceleration_m_per_s2). Turning on the spot of a round body always is free.
  [[nodiscard]] Judgement judge(const geometry::Velocity& wanted, double brake_m_per_s2,
                                std::int64_t now_ns) const;

 private:
  [[nodiscard]] std::vector<Eigen::Vector2d> points_now_m() const;
  [[nodiscard]] bool sees(std::int64_t now_ns) const;
  [[nodiscard]] bool repeats(const ScanPoints& scan);

  GuardConfig config_;
  double runs_on_s_;
  geometry::OdometryTrack track_;
  std::optional<geometry::OdometrySample> last_;
  std::optional<ScanPoints> scan_;       ///< smoothed
  std::vector<Eigen::Vector2d> seen_m_;  ///< of the last scan, as measured ...
  geometry::Pose2 T_odom_seen_;          ///< ... and where the robot was when they came first
};

}  // namespace topogeo::navigation
