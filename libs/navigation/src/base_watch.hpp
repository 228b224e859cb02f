// Detects a base that does not move when ordered to.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/geometry/velocity.hpp"

namespace topogeo::navigation {

class BaseWatch {
 public:
  explicit BaseWatch(double stuck_s) : stuck_ns_(static_cast<std::int64_t>(stuck_s * 1e9)) {}

  /// Takes the current order and the odometry of `odometry_ns`. True: the base has not moved for
  /// `stuck_s` though ordered to all the time. Late odometry proves nothing about the time after
  /// its stamp. The time starts again after a gap in the orders, because a base without orders
  /// stops by itself.
  bool stuck(const geometry::Velocity& ordered, const geometry::Pose2& T_odom_robot,
             std::int64_t odometry_ns, std::int64_t now_ns) {
    constexpr double kLeast_m_per_s = 0.02;    // friction may stop slower motion
    constexpr double kLeast_rad_per_s = 0.05;  // the same
    constexpr double kMoved_m = 0.01;          // less may be play of the wheels
    constexpr double kMoved_rad = 0.02;        // the same
    const bool moves = std::fabs(ordered.linear_m_per_s) >= kLeast_m_per_s ||
                       std::fabs(ordered.angular_rad_per_s) >= kLeast_rad_per_s;
    if (!moves) {
      reset();
      return false;
    }
    if (now_ns - ordered_ns_ > kLongestGap_ns) T_odom_then_.reset();
    ordered_ns_ = now_ns;
    if (T_odom_then_) {
      const geometry::Pose2 step = between(*T_odom_then_, T_odom_robot);
      if (step.position_m().norm() < kMoved_m && std::fabs(step.theta_rad) < kMoved_rad) {
        return odometry_ns - since_ns_ >= stuck_ns_;
      }
      since_ns_ = odometry_ns;
    } else {
      since_ns_ = now_ns;  // the order is new
    }
    T_odom_then_ = T_odom_robot;
    return false;
  }

  void reset() { T_odom_then_.reset(); }

 private:
  static constexpr auto kLongestGap_ns = static_cast<std::int64_t>(geometry::kCommandValid_s * 1e9);

  std::int64_t stuck_ns_;
  std::int64_t ordered_ns_ = 0;  ///< time of the last order
  std::int64_t since_ns_ = 0;
  std::optional<geometry::Pose2> T_odom_then_;
};

}  // namespace topogeo::navigation
