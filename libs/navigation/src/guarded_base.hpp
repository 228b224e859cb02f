// The base behind its collision guard: every velocity passes here, and every reason of base and
// sensors not to move at all.
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
  /// The load of this machine at `now_ns`. A base that seems stuck while the machine is busy may
  /// get its orders too late to obey them: it is tried again once the machine has time, kTries
  /// times at most until it moves.
  void set(const MachineLoad& load, std::int64_t now_ns);
  void keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m) {
    guard_.keep_off(stamp_ns, std::move(points_m));
  }

  /// Why no motion at all is possible, with one line for people; kNone when it is.
  HaltReason halted(std::int64_t now_ns, std::string& message) const;

  struct Command {
    GuardVerdict verdict;
    bool stopped = false;        ///< the guard allows nothing of a motion ahead
    bool newly_stopped = false;  ///< and allowed some of it before
  };
  /// What of a wanted velocity the base gets. Without odometry a base that does not move is not
  /// noticed.
  Command command(const geometry::Velocity& wanted,
                  const std::optional<geometry::Pose2>& T_odom_robot, std::int64_t now_ns);
  /// The base gets the order to stand.
  void stand() { watch_.reset(); }

  /// The guard has stopped the motion ahead for longer than it takes a passer-by to step aside.
  [[nodiscard]] bool held(std::int64_t now_ns) const;
  /// Another path or another order: what the guard has stopped before does not count any more.
  void release() { stopped_ns_.reset(); }
  /// A base that was stuck may be tried again.
  void retry();

  [[nodiscard]] const CollisionGuard& guard() const { return guard_; }

 private:
  static constexpr int kTries = 3;

  void watch_motion(const geometry::Velocity& ordered, const geometry::Pose2& T_odom_robot,
                    std::int64_t now_ns);
  void judge_try(std::int64_t now_ns);
  void retry_now();

  double stuck_s_;
  CollisionGuard guard_;
  NearEchoes near_;
  BaseWatch watch_;
  std::optional<BaseCondition> base_;
  std::int64_t odometry_ns_ = 0;  ///< of the newest
  bool stuck_ = false;
  std::int64_t stuck_ns_ = 0;               ///< when it was judged so last
  std::optional<std::int64_t> busy_ns_;     ///< when the machine was last busy
  bool tries_again_ = false;                ///< stuck, but perhaps because the machine was busy
  int tries_ = 0;                           ///< since it last moved
  geometry::Pose2 T_odom_stuck_;            ///< where it last was stuck
  std::optional<std::int64_t> stopped_ns_;  ///< since when the guard stops the motion ahead
};

}  // namespace topogeo::navigation
