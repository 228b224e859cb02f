#include "orders/manual_drive.hpp"

#include <algorithm>

namespace topogeo::web {

bool ManualDrive::hold(std::uint64_t viewer, const geometry::Velocity& wanted,
                       std::int64_t steady_ns) {
  if (held(steady_ns) && holder_ != viewer) return false;
  holder_ = viewer;
  heard_ns_ = steady_ns;
  const double speed = limits_.speed_m_per_s;
  const double turn = limits_.turn_rad_per_s;
  wanted_.linear_m_per_s = std::clamp(wanted.linear_m_per_s, -speed, speed);
  wanted_.angular_rad_per_s = std::clamp(wanted.angular_rad_per_s, -turn, turn);
  return true;
}

void ManualDrive::release(std::uint64_t viewer, std::int64_t steady_ns) {
  if (holder_ == viewer) let_go(steady_ns);
}

void ManualDrive::let_go(std::int64_t steady_ns) {
  if (!holder_) return;
  holder_.reset();
  zeros_until_ns_ = steady_ns + kStopTail_ns;
}

bool ManualDrive::held(std::int64_t steady_ns) const {
  return holder_ && steady_ns - heard_ns_ <= kPatience_ns;
}

std::optional<navigation::GuardVerdict> ManualDrive::step(const navigation::CollisionGuard& guard,
                                                          std::int64_t steady_ns,
                                                          std::int64_t sensors_ns) {
  if (!held(steady_ns)) let_go(steady_ns);
  if (holder_) return guard.judge(wanted_, sensors_ns);
  if (steady_ns < zeros_until_ns_) return navigation::GuardVerdict{};
  return std::nullopt;
}

}  // namespace topogeo::web
