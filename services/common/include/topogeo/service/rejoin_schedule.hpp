// Timing for a service whose main input is silent: when it asks others why, reports that it is
// deaf, and exits for a restart. A restarted service discovers all peers anew; one that is deaf
// from its start waits longer each time, so that a fault that no restart cures costs little.
#pragma once

#include <cstdint>

#include "topogeo/messaging/deafness.hpp"

namespace topogeo::service {

/// The state of the main input now.
struct InputState {
  double silence_s = 0.0;     ///< messaging::input_silence_s
  bool ever_came = false;     ///< in this run
  bool hears_sender = false;  ///< the sender's status arrives
  bool deaf = false;          ///< proven: the sender sends, and nothing arrives
};

struct RejoinStep {
  bool listen = false;  ///< read the statuses of other services
  bool probe = false;   ///< read them through another participant, which discovers all peers anew
  bool report = false;  ///< report now that the service is deaf
  bool end = false;     ///< exit now
};

/// Call it several times a second with the time in seconds, counted from any start.
class RejoinSchedule {
 public:
  /// The wait from the proof to the exit in the second deaf run in a row.
  static constexpr double kFirstWait_s = 60.0;
  /// The same in all further runs.
  static constexpr double kNextWait_s = 600.0;
  static constexpr double kReportEvery_s = 60.0;
  /// Listening time without a status of the sender after which the service probes.
  static constexpr double kListen_s = 2.0;
  /// A probe that hears nothing ends after this time. Discovery takes one second, two with
  /// security.
  static constexpr double kProbe_s = 10.0;
  static constexpr double kLongestPause_s = 600.0;

  /// `deaf_lives`: number of runs of the service before this one, in a row, that ended deaf.
  explicit RejoinSchedule(std::uint32_t deaf_lives) : deaf_lives_(deaf_lives) {}

  RejoinStep step(const InputState& input, double now_s);

  /// Number of deaf runs in a row if this one ends now; 0 once its input has arrived and is not
  /// dead.
  [[nodiscard]] std::uint32_t deaf_lives() const { return deaf_lives_; }

 private:
  [[nodiscard]] std::uint32_t lives_before(const InputState& input) const;
  [[nodiscard]] double wait_s(const InputState& input) const;
  void decide_probe(const InputState& input);

  std::uint32_t deaf_lives_;
  bool listens_ = false;
  bool probes_ = false;
  double probe_since_s_ = 0.0;  // silence when the probe began
  double probe_due_s_ = 0.0;    // silence when the next one begins
  bool deaf_ = false;
  double deaf_since_s_ = 0.0;
  double report_due_s_ = 0.0;
};

}  // namespace topogeo::service
