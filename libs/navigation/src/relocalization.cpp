#include "relocalization.hpp"

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {

void Relocalization::begin(std::int64_t now_ns) {
  lost_ns_ = now_ns;
  look_around_.reset();
}

Relocalization::Step Relocalization::step(const Lost& lost, const CollisionGuard& guard,
                                          std::int64_t now_ns) {
  constexpr double kStandsFirst_s = 1.0;  // many poses return by themselves
  // A merely uncertain pose is mostly right, and one turn on the spot confirms it.
  const bool may_move = lost.may_look_around || (lost.doubtful && !look_around_.been_round());
  if (!may_move || farthest_m_ <= 0.0 || !lost.T_odom_robot) return {std::nullopt, lost.why};
  if (look_around_.finished()) {
    return {std::nullopt, fmt::format("{}; looked around over {:.1f} m without finding the pose",
                                      lost.why, look_around_.gone_m())};
  }
  if (elapsed_s(lost_ns_, now_ns) < kStandsFirst_s) return {std::nullopt, lost.why};
  std::string message = fmt::format("{}; looks around, {:.1f} of {:.1f} m", lost.why,
                                    look_around_.gone_m(), farthest_m_);
  return {look_around_.step(*lost.T_odom_robot, guard, now_ns), std::move(message)};
}

}  // namespace topogeo::navigation
