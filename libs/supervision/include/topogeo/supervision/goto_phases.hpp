// Phases of a run that sends a robot to a goal: wait for the start, drive, call the goal off.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/supervision/goal_watch.hpp"
#include "topogeo/support/patience.hpp"

namespace topogeo::supervision {

/// State of a run at one moment.
struct GotoView {
  std::string waits_for;       ///< the robot needs it to set out; empty: nothing
  std::string busy;            ///< why the machine is too busy; empty: it is not
  std::optional<GoalEnd> end;  ///< of the goal, once sent
  bool stands = false;         ///< the robot does not drive and has no command to move
};

/// The next step of the run.
enum class GotoAction : std::uint8_t {
  kNone,
  kSendGoal,
  kCallOff,  ///< the goal was not reached: failure() has the reason
  kFail,     ///< the start has taken too long: failure() names the missing part
  kEnd,      ///< the robot has arrived, or has stopped after the goal was called off
};

/// Has no clock: the caller passes the time, in seconds from any start, several times a second.
class GotoPhases {
 public:
  static constexpr double kStart_s = 120.0;  ///< to start services and localize
  static constexpr double kCallOff_s = 5.0;  ///< to stop the robot

  explicit GotoPhases(double now_s) : clock_(now_s) {}

  /// Time does not count while the machine is busy.
  GotoAction step(double now_s, const GotoView& view);
  /// The operator gives up: the caller calls the goal off. False if that was already done.
  bool call_off();

  [[nodiscard]] bool is_waiting() const { return phase_ == Phase::kWaiting; }
  [[nodiscard]] bool is_driving() const { return phase_ == Phase::kDriving; }
  [[nodiscard]] bool has_arrived() const { return arrived_; }
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// Time from the goal to its end; 0 before.
  [[nodiscard]] double drive_s() const { return drive_s_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kDriving, kCallingOff, kEnded };

  GotoAction wait_for_start(double now_s, const GotoView& view);
  GotoAction drive(double now_s, const GotoView& view);
  GotoAction wait_for_stop(const GotoView& view);

  Phase phase_ = Phase::kWaiting;
  support::PatienceClock clock_;
  double called_off_s_ = 0.0;  // by the patience clock
  double sent_s_ = 0.0;        // by the caller's clock
  double drive_s_ = 0.0;
  bool arrived_ = false;
  std::string failure_;
};

}  // namespace topogeo::supervision
