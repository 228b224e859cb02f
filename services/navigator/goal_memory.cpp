#include "goal_memory.hpp"

namespace topogeo::navigator {

namespace {

constexpr std::uint64_t kFormat = 0x344C414F47475054;  // "TPGGOAL4": the layout of Record

}  // namespace

std::optional<RememberedGoal> to_remember(const std::optional<navigation::GoalOrder>& goal,
                                          bool paused, const navigation::Navigator& navigator) {
  if (goal) return RememberedGoal{*goal, paused, navigator.is_stuck(), false};
  const navigation::NavigatorStatus& now = navigator.status();
  if (!paused || now.state != navigation::NavigatorState::kArrived) return std::nullopt;
  return RememberedGoal{{now.goal_id, false}, true, false, true};
}

void restore(const RememberedGoal& goal, navigation::Navigator& navigator) {
  navigator.set_goal(goal.order);
  if (goal.arrived) navigator.stay_arrived("arrived");
  if (goal.paused) navigator.pause();
  if (goal.stuck) navigator.stay_stuck();
}

GoalMemory::GoalMemory(const std::filesystem::path& path, std::uint64_t boot)
    : file_(path, kFormat), boot_(boot) {}

std::optional<RememberedGoal> GoalMemory::load() const {
  const std::optional<Record> record = file_.load();
  if (!record || record->goal_id == 0 || record->boot != boot_) return std::nullopt;
  return RememberedGoal{{record->goal_id, record->look_around != 0},
                        record->paused != 0,
                        record->stuck != 0,
                        record->arrived != 0};
}

void GoalMemory::store(const std::optional<RememberedGoal>& goal) {
  Record record;
  if (goal) {
    record = {goal->order.goal_id,   goal->order.look_around ? 1U : 0U, goal->paused ? 1U : 0U,
              goal->stuck ? 1U : 0U, goal->arrived ? 1U : 0U,           boot_};
  }
  if (stored_ == record) return;
  static_cast<void>(file_.store(record));
  stored_ = record;
}

}  // namespace topogeo::navigator
