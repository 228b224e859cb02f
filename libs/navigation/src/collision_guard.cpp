#include "topogeo/navigation/collision_guard.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "topogeo/navigation/arc_sweep.hpp"
#include "topogeo/navigation/outline_sweep.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::navigation {
namespace {

constexpr double kStanding_m_s = 1e-6;  // slower motion counts as none
constexpr double kRolls_m_s = 0.05;     // below this it stops at once

std::string describe_contact(bool is_drawn, double free_m, bool ahead) {
  constexpr double kTouches_m = 0.01;
  const char* what = is_drawn ? "a drawn wall or no-go zone" : "something";
  if (free_m < kTouches_m) {
    return fmt::format("{} is right {} the body", what, ahead ? "in front of" : "behind");
  }
  return fmt::format("{} is {:.2f} m {} the body", what, free_m, ahead ? "ahead of" : "behind");
}

bool turns_on_the_spot(const geometry::Velocity& motion) {
  return std::fabs(motion.linear_m_per_s) < kStanding_m_s;
}

struct Reach {
  double free_m = 0.0;  ///< straight ahead for a turn on the spot
  double stop_m = 0.0;  ///< within which it must stop; for an outline the way of its fastest corner
  std::optional<std::size_t> contact;  ///< index of the point that ends it
};

/// How far the body moves until it touches a point. A disc that turns on the spot touches nothing:
/// it looks ahead.
Reach reach_of(const geometry::Velocity& motion, const std::vector<Eigen::Vector2d>& points_m,
               const GuardConfig& config) {
  constexpr geometry::Velocity kAhead{1.0, 0.0};
  const bool turns = turns_on_the_spot(motion);
  const double margin_m = std::min(config.margin_m, config.side_margin_m);
  if (config.footprint.empty()) {
    const SweptArc arc = sweep(turns ? kAhead : motion, points_m, config.radius_m + margin_m,
                               CollisionGuard::kFarthest_m);
    return {arc.length_m, arc.length_m, arc.contact};
  }
  const auto swept_by = [&](const geometry::Velocity& of_body) {
    return sweep(of_body, points_m, config.footprint, margin_m, CollisionGuard::kFarthest_m);
  };
  const OutlineSweep swept = swept_by(motion);
  return {turns ? swept_by(kAhead).length_m : swept.length_m, swept.reach_m, swept.contact};
}

/// m/s; that of the fastest corner of an outline.
double body_speed(const geometry::Velocity& motion, const GuardConfig& config) {
  return config.footprint.empty() ? std::fabs(motion.linear_m_per_s)
                                  : outline_speed(motion, config.footprint);
}

/// Whether the body moves, and `wanted` goes the same way.
bool goes_on(const geometry::Velocity& now, const geometry::Velocity& wanted,
             const GuardConfig& config) {
  const double arm_m =
      config.footprint.empty() ? 0.0 : geometry::circumscribed_radius_m(config.footprint);
  return now.linear_m_per_s * wanted.linear_m_per_s +
                 arm_m * arm_m * now.angular_rad_per_s * wanted.angular_rad_per_s >
             0.0 &&
         body_speed(now, config) > kRolls_m_s;
}

void refuse_backward(GuardVerdict& verdict) {
  verdict.allowed = {};
  verdict.limited = true;
  verdict.reason = HaltReason::kSonarSilent;
  verdict.message = "backward motion needs a fresh sonar reading";
}

/// Allows a speed below the wanted one, or none where it is less than bases go.
void slow_down(GuardVerdict& verdict, double speed, double asked) {
  constexpr double kCreep_m_per_s = 0.01;
  verdict.limited = true;
  verdict.allowed.linear_m_per_s *= speed / asked;
  verdict.allowed.angular_rad_per_s *= speed / asked;
  if (speed < kCreep_m_per_s) {
    verdict.allowed = {};
    verdict.reason = HaltReason::kObstacle;
  }
}

}  // namespace

CollisionGuard::CollisionGuard(const GuardConfig& config) : config_(config), inputs_(config) {
  check(config);
}

void CollisionGuard::add(const LaserFields& fields) {
  if (!fields_ || fields.stamp_ns > fields_->stamp_ns) fields_ = fields;
}

double CollisionGuard::reaction_s(std::int64_t now_ns) const {
  return inputs_.age_s(now_ns) + config_.delay_s + config_.runs_on_s;
}

double CollisionGuard::speed_for(double free_m, double reaction_s) const {
  const double kept_m = std::max(0.0, config_.margin_m - config_.side_margin_m);
  return stopping_speed(free_m - kept_m, reaction_s, config_.deceleration_m_per_s2);
}

GuardVerdict CollisionGuard::judge(const geometry::Velocity& wanted, std::int64_t now_ns) const {
  const geometry::Velocity possible = geometry::drivable(wanted, config_.minimum_turning_radius_m);
  GuardVerdict verdict = judge_by_distances(possible, now_ns);
  if (config_.laser_fields && fields_) obey_fields(verdict);
  if (possible == wanted || verdict.reason != HaltReason::kNone) return verdict;
  verdict.limited = true;
  if (possible == geometry::Velocity{}) {
    verdict.reason = HaltReason::kBaseNotReady;
    verdict.message = fmt::format(
        "the drive unit cannot turn on the spot: its smallest turning radius is {:.2f} m",
        config_.minimum_turning_radius_m);
  }
  return verdict;
}

void CollisionGuard::obey_fields(GuardVerdict& verdict) const {
  const double ahead = verdict.allowed.linear_m_per_s;
  if (ahead < kStanding_m_s || !(fields_->warning || fields_->protective)) return;
  const double most = fields_->protective ? 0.0 : config_.warning_field_m_per_s;
  if (ahead <= most) return;
  verdict.limited = true;
  verdict.allowed.linear_m_per_s *= most / ahead;
  verdict.allowed.angular_rad_per_s *= most / ahead;
  verdict.message = "something is in the warning field of the laser";
  if (!fields_->protective) return;
  verdict.reason = HaltReason::kObstacle;
  verdict.message = "something is in the protective field of the laser";
}

GuardVerdict CollisionGuard::judge_by_distances(const geometry::Velocity& wanted,
                                                std::int64_t now_ns) const {
  GuardVerdict verdict;
  verdict.reason = health(now_ns, &verdict.message);
  if (verdict.reason != HaltReason::kNone) {
    verdict.limited = wanted != geometry::Velocity{};
    return verdict;
  }
  const GuardInputs::Obstacles obstacles = inputs_.obstacles(now_ns);
  const Reach reach = reach_of(wanted, obstacles.points_m, config_);
  const bool is_drawn = reach.contact && *reach.contact >= obstacles.first_drawn;
  if (reach.contact && !is_drawn) verdict.contact_m = obstacles.points_m[*reach.contact];
  verdict.free_m = reach.free_m;
  verdict.allowed = wanted;
  const double asked = body_speed(wanted, config_);
  if (asked < kStanding_m_s) return verdict;
  if (wanted.linear_m_per_s < -kStanding_m_s && !inputs_.has_fresh_sonar(now_ns)) {
    refuse_backward(verdict);
    return verdict;
  }
  const double late_s = reaction_s(now_ns);
  double speed = speed_for(reach.stop_m, late_s);
  const geometry::Velocity now = inputs_.driven();
  if (goes_on(now, wanted, config_)) {
    speed = std::min(speed, speed_for(reach_of(now, obstacles.points_m, config_).stop_m, late_s));
  }
  if (speed >= asked) return verdict;
  slow_down(verdict, speed, asked);
  verdict.message = turns_on_the_spot(wanted)
                        ? "no room to turn on the spot"
                        : describe_contact(is_drawn, reach.free_m, wanted.linear_m_per_s > 0.0);
  return verdict;
}

}  // namespace topogeo::navigation
