#include "pose_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/support/format.hpp"

namespace topogeo::navigation {
namespace {

constexpr std::int64_t kCarriedOn_ns = 300'000'000;  // after the last odometry, by its speeds

double seconds(std::int64_t duration_ns) {
  return static_cast<double>(duration_ns) * 1e-9;
}

/// Standard deviations of the position along the axes of its error ellipse.
struct Sigmas {
  double largest_m = 0.0;
  double smallest_m = 0.0;
};

Sigmas sigmas_of(const Eigen::Matrix3d& covariance) {
  const double half = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double spread = std::hypot(0.5 * (covariance(0, 0) - covariance(1, 1)), covariance(0, 1));
  return {std::sqrt(std::max(0.0, half + spread)), std::sqrt(std::max(0.0, half - spread))};
}

}  // namespace

PoseKeeper::PoseKeeper(const PoseKeeperConfig& config)
    : config_(config), odometry_(kCarriedOn_ns) {}

void PoseKeeper::add(const OdometrySample& sample) {
  geometry::OdometrySample moving{sample.stamp_ns, sample.T_odom_robot};
  if (last_ && sample.stamp_ns > last_->stamp_ns) {
    const geometry::Pose2 step = between(last_->T_odom_robot, sample.T_odom_robot);
    const double time_s = std::max(0.01, seconds(sample.stamp_ns - last_->stamp_ns));
    moving.linear_mps = step.x_m / time_s;
    moving.angular_radps = step.theta_rad / time_s;
  }
  if (!odometry_.add(moving)) return;
  if (last_) {
    const double step_m =
        (sample.T_odom_robot.position_m() - last_->T_odom_robot.position_m()).norm();
    driven_m_ += step_m;
    untracked_m_ += step_m;
  }
  last_ = sample;
  if (pending_ && pending_->stamp_ns <= sample.stamp_ns) use(*std::exchange(pending_, {}));
}

void PoseKeeper::add(const PoseFix& fix) {
  if (fix_ && fix.stamp_ns < fix_->stamp_ns) return;
  if (!fix.tracking && !fix.located) {  // counts at once, with any odometry
    fix_ = fix;
    tracked_ = false;
    pending_.reset();
    return;
  }
  if (!last_ || fix.stamp_ns > last_->stamp_ns) {
    pending_ = fix;
    return;
  }
  use(fix);
}

void PoseKeeper::use(const PoseFix& fix) {
  const auto then = odometry_.at(fix.stamp_ns);
  if (!then) return;  // older than all stored odometry
  const geometry::Pose2 T_map_odom = fix.T_map_robot * inverse(then->T_odom_robot);
  if (fix_ && last_) {
    const Eigen::Vector2d robot_m = last_->T_odom_robot.position_m();
    jump_m_ = std::max(jump_m_, (T_map_odom * robot_m - T_map_odom_ * robot_m).norm());
  }
  T_map_odom_ = T_map_odom;
  fix_ = fix;
  if (!fix.tracking && !fix.place_known) return;
  tracked_ = true;
  untracked_m_ = 0.0;
}

bool PoseKeeper::usable() const {
  if (!fix_) return false;
  return fix_->tracking || (fix_->located && tracked_ && untracked_m_ <= config_.untracked_m);
}

bool PoseKeeper::certain() const {
  const Sigmas sigmas = sigmas_of(fix_->covariance);
  return sigmas.smallest_m <= config_.largest_sigma_m &&
         sigmas.largest_m <= kLengthwise * config_.largest_sigma_m;
}

bool PoseKeeper::has_odometry(std::int64_t now_ns) const {
  return last_ && seconds(now_ns - last_->stamp_ns) <= config_.oldest_odometry_s;
}

std::optional<geometry::Pose2> PoseKeeper::T_odom_robot(std::int64_t now_ns) const {
  if (!has_odometry(now_ns)) return std::nullopt;
  const auto answer = odometry_.at(std::min(now_ns, last_->stamp_ns + kCarriedOn_ns));
  if (!answer) return std::nullopt;
  return answer->T_odom_robot;
}

std::optional<geometry::Pose2> PoseKeeper::T_map_robot(std::int64_t at_ns) const {
  if (!usable() || !last_) return std::nullopt;
  const auto answer = odometry_.at(std::min(at_ns, last_->stamp_ns + kCarriedOn_ns));
  if (!answer) return std::nullopt;
  return T_map_odom_ * answer->T_odom_robot;
}

std::optional<geometry::Pose2> PoseKeeper::good_pose(std::int64_t now_ns) const {
  if (!usable() || !has_odometry(now_ns)) return std::nullopt;
  if (seconds(now_ns - fix_->stamp_ns) > config_.oldest_pose_s) return std::nullopt;
  if (!certain()) return std::nullopt;
  return T_map_robot(now_ns);
}

std::string PoseKeeper::why_not(std::int64_t now_ns) const {
  if (!fix_) return "no pose received yet";
  if (!usable()) {
    return fmt::format("the localizer does not track the pose: {}",
                       fix_->state_text.empty() ? "no reason given" : fix_->state_text);
  }
  if (seconds(now_ns - fix_->stamp_ns) > config_.oldest_pose_s) {
    return fmt::format("the last pose is {:.1f} s old", seconds(now_ns - fix_->stamp_ns));
  }
  if (!certain()) {
    return fmt::format(
        "the pose is uncertain by {:.2f} m one way and {:.2f} m the other, expected at most {:.2f} "
        "and {:.2f} m",
        sigma_m(), sigmas_of(fix_->covariance).smallest_m, kLengthwise * config_.largest_sigma_m,
        config_.largest_sigma_m);
  }
  return "no odometry";
}

std::optional<std::int64_t> PoseKeeper::fix_ns() const {
  if (!fix_) return std::nullopt;
  return fix_->stamp_ns;
}

double PoseKeeper::sigma_m() const {
  return fix_ ? sigmas_of(fix_->covariance).largest_m : HUGE_VAL;
}

double PoseKeeper::take_jump_m() {
  return std::exchange(jump_m_, 0.0);
}

double PoseKeeper::take_driven_m() {
  return std::exchange(driven_m_, 0.0);
}

}  // namespace topogeo::navigation
