// The base behind its collision guard: limits every velocity, and checks whether the state of base
// and sensors forbids any motion.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/collision_guard.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

#include "base_watch.hpp"
#include "near_echoes.hpp"

namespace topogeo::navigation {

class GuardedBase {
 public:
  GuardedBase(const GuardConfig& guard, double stuck_s);

  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan) { guard_.add(scan); }
  void add(const SonarRound& sonar);
  void add(const LaserFields& fields) { guard_.add(fields); }
  void add(const BaseCondition& base) { base_ = base; }
  /// Sets a reason to stand that the base does not report, as text for people; empty: none.
  void set_stopped(std::string why) { stopped_ = std::move(why); }
  /// Sets the load of this machine at `now_ns`. A base that seems stuck while the machine is busy
  /// may have got its commands too late. It is tried again once the machine has time, at most
  /// kTries times until it moves.
  void set(const MachineLoad& load, std::int64_t now_ns);
  void keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
    guard_.keep_off(stamp_ns, std::move(points_m));
  }

  /// The reason why no motion is possible, or kNone. `message` gets one line of text for people.
  HaltReason halted(std::int64_t now_ns, std::string& message) const;

  struct Command {
    GuardVerdict verdict;
    bool stopped = false;        ///< the guard allows no motion ahead
    bool newly_stopped = false;  ///< as `stopped`, but it allowed some at the last command
  };
  /// The part of a wanted velocity that the guard allows. Without odometry, a stuck base is not
  /// detected.
  Command command(const geometry::Velocity& wanted,
                  const std::optional<geometry::Pose2>& T_odom_robot, std::int64_t now_ns);
  /// Records that the base is commanded to stand.
  void stand() { watch_.reset(); }

  /// Whether the guard has stopped motion ahead for longer than a passer-by needs to step aside.
  [[nodiscard]] bool held(std::int64_t now_ns) const;
  /// Discards the guard's earlier stops, because another path or order applies.
  void release() { stopped_ns_.reset(); }
  /// Lets a stuck base try again.
  void retry();
  /// Whether the base is stuck and stands until retry().
  [[nodiscard]] bool is_stuck() const { return stuck_ns_ && !tries_again_; }
  /// Makes the base stand until retry(), as if it had been found stuck.
  void stay_stuck();

  [[nodiscard]] const CollisionGuard& guard() const { return guard_; }

 private:
  static constexpr int kTries = 3;

  void watch_motion(const geometry::Velocity& ordered, const geometry::Pose2& T_odom_robot,
                    std::int64_t now_ns);
  void judge_try(std::int64_t now_ns);
  void retry_now();

  double stuck_s_;
  bool outlined_;  ///< obstacles also stop turns and motion backwards
  CollisionGuard guard_;
  NearEchoes near_;
  BaseWatch watch_;
  std::optional<BaseCondition> base_;
  std::string stopped_;                     ///< reason to stand; empty: none
  std::int64_t odometry_ns_ = 0;            ///< stamp of the newest odometry
  std::optional<std::int64_t> stuck_ns_;    ///< last detection; empty: not stuck
  std::optional<std::int64_t> busy_ns_;     ///< when the machine was last busy
  bool tries_again_ = false;                ///< stuck, but maybe for lack of CPU time
  int tries_ = 0;                           ///< since the last motion
  geometry::Pose2 T_odom_stuck_;            ///< last pose when stuck
  std::optional<std::int64_t> stopped_ns_;  ///< start of the guard's stop
};

}  // namespace topogeo::navigation
