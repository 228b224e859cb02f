// Remembers the goal under way, or a pause at the goal that was reached, in a small file that
// survives a killed navigator. The client that gave the goal may be gone, so its order exists
// nowhere else. Lists of goals and explorations wait for the end of a pause.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "topogeo/navigation/navigator.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/record_file.hpp"

namespace topogeo::navigator {

struct RememberedGoal {
  navigation::GoalOrder order;
  bool paused = false;
  bool stuck = false;    ///< the base did not move when ordered to: it stands until a resume
  bool arrived = false;  ///< the robot has reached it, and is paused there
};

/// The state that the next navigator resumes. `goal`: the one under way; empty: none. Empty if
/// there is nothing to resume.
std::optional<RememberedGoal> to_remember(const std::optional<navigation::GoalOrder>& goal,
                                          bool paused, const navigation::Navigator& navigator);

/// Brings a navigator that has just begun into that state.
void restore(const RememberedGoal& goal, navigation::Navigator& navigator);

class GoalMemory {
 public:
  /// With an empty path nothing is kept. Throws std::runtime_error naming the file when it cannot
  /// be opened or made.
  explicit GoalMemory(const std::filesystem::path& path, std::uint64_t boot = support::this_boot());

  /// The goal stored last since the machine was started; empty when there is none. A robot that is
  /// switched on stands.
  [[nodiscard]] std::optional<RememberedGoal> load() const;
  /// Writes only changes. Empty: the robot has no goal, and is not paused at one.
  void store(const std::optional<RememberedGoal>& goal);

 private:
  struct Record {
    std::uint64_t goal_id = 0;  // 0: none
    std::uint32_t look_around = 0;
    std::uint32_t paused = 0;
    std::uint32_t stuck = 0;
    std::uint32_t arrived = 0;
    std::uint64_t boot = 0;
    bool operator==(const Record&) const = default;
  };

  support::RecordFile<Record> file_;
  std::uint64_t boot_;            // of the machine
  std::optional<Record> stored_;  // by this process
};

}  // namespace topogeo::navigator
