#include "topogeo/navigation/command_history.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/navigation/arc_sweep.hpp"

namespace topogeo::navigation {
namespace {

/// More than the longest delay of a base that follower.delay_s allows.
constexpr std::int64_t kKept_ns = 1'500'000'000;
/// Slower commands count as standing, because no base moves that slowly.
constexpr double kStands_m_s = 1e-3;
constexpr double kStands_rad_s = 5e-3;

}  // namespace

void CommandHistory::add(const geometry::Velocity& command, std::int64_t now_ns) {
  commands_.push_back({now_ns, command});
  while (commands_.size() > 1 && commands_[1].stamp_ns < now_ns - kKept_ns) commands_.pop_front();
}

bool CommandHistory::stands() const {
  if (commands_.empty()) return true;
  const std::int64_t since_ns =
      commands_.back().stamp_ns - static_cast<std::int64_t>(delay_s_ * 1e9);
  return std::all_of(commands_.rbegin(), commands_.rend(), [&](const Command& command) {
    return command.stamp_ns < since_ns ||
           (std::fabs(command.velocity.linear_m_per_s) < kStands_m_s &&
            std::fabs(command.velocity.angular_rad_per_s) < kStands_rad_s);
  });
}

geometry::Pose2 CommandHistory::predicted(const geometry::Pose2& T_map_robot,
                                          std::int64_t now_ns) const {
  geometry::Pose2 pose = T_map_robot;
  const std::int64_t from_ns = now_ns - static_cast<std::int64_t>(delay_s_ * 1e9);
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    const std::int64_t begin_ns = std::max(commands_[i].stamp_ns, from_ns);
    const std::int64_t end_ns = i + 1 < commands_.size() ? commands_[i + 1].stamp_ns : now_ns;
    if (end_ns <= begin_ns) continue;
    pose = pose * moved(commands_[i].velocity, static_cast<double>(end_ns - begin_ns) * 1e-9);
  }
  return pose;
}

geometry::Velocity CommandHistory::last() const {
  return commands_.empty() ? geometry::Velocity{} : commands_.back().velocity;
}

double CommandHistory::since_last_s(std::int64_t now_ns, double otherwise_s) const {
  if (commands_.empty()) return otherwise_s;
  return static_cast<double>(now_ns - commands_.back().stamp_ns) * 1e-9;
}

}  // namespace topogeo::navigation
