// The course of a run that sends a robot somewhere: wait for the start, drive, call the goal off.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "topogeo/supervision/goal_watch.hpp"
#include "topogeo/support/patience.hpp"

namespace topogeo::supervision {

/// The view of a run at a moment.
struct GotoView {
  std::string waits_for;       ///< before the robot may set out; empty: for nothing
  std::string busy;            ///< why the machine is too busy; empty when it is not
  std::optional<GoalEnd> end;  ///< of the goal, once it was sent
  bool stands = false;         ///< the robot does not drive and is not commanded to move
};

/// The next step of the run.
enum class GotoAction : std::uint8_t {
  kNone,
  kSendGoal,
  kCallOff,  ///< the goal was not reached: failure() says why
  kFail,     ///< the start has taken too long: failure() says what lacks
  kEnd,      ///< the robot has arrived, or stands after the goal was called off
};

/// Has no clock: the caller passes the time, in seconds from any start, several times a second.
class GotoPhases {
 public:
  static constexpr double kStart_s = 120.0;  ///< for services to start and the robot to find itself
  static constexpr double kCallOff_s = 5.0;  ///< for the robot to stop

  explicit GotoPhases(double now_s) : clock_(now_s) {}

  /// Time does not count while the machine is busy.
  GotoAction step(double now_s, const GotoView& view);
  /// The operator has had enough: the caller calls the goal off. False when that has been done.
  bool call_off();

  [[nodiscard]] bool is_waiting() const { return phase_ == Phase::kWaiting; }
  [[nodiscard]] bool is_driving() const { return phase_ == Phase::kDriving; }
  [[nodiscard]] bool has_arrived() const { return arrived_; }
  [[nodiscard]] const std::string& failure() const { return failure_; }
  /// From the goal to its end; 0 before.
  [[nodiscard]] double drive_s() const { return drive_s_; }

 private:
  enum class Phase : std::uint8_t { kWaiting, kDriving, kCallingOff, kEnded };

  GotoAction wait_for_start(double now_s, const GotoView& view);
  GotoAction drive(double now_s, const GotoView& view);
  GotoAction wait_for_stop(const GotoView& view);

  Phase phase_ = Phase::kWaiting;
  support::PatienceClock clock_;
  double called_off_s_ = 0.0;  // by the patience clock
  double sent_s_ = 0.0;        // by the caller's
  double drive_s_ = 0.0;
  bool arrived_ = false;
  std::string failure_;
};

}  // namespace topogeo::supervision
