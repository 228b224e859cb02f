// When a service whose main input is silent asks others why, reports that it is deaf, and ends in
// order to be started again. A new life meets all peers anew; one that is deaf from its start on
// waits longer each time, so that a fault which no restart mends costs little.
#pragma once

#include <cstdint>

#include "topogeo/messaging/deafness.hpp"

namespace topogeo::service {

/// The state of the main input now.
struct InputState {
  double silence_s = 0.0;     ///< messaging::input_silence_s
  bool ever_came = false;     ///< in this life
  bool hears_sender = false;  ///< the status of its sender comes in
  bool deaf = false;          ///< proven
};

struct RejoinStep {
  bool listen = false;  ///< to the statuses of other services
  bool probe = false;   ///< the same by another participant, which meets all peers anew
  bool report = false;  ///< that it is deaf, now
  bool end = false;     ///< now
};

/// The caller passes the time, in seconds from any start, several times a second.
class RejoinSchedule {
 public:
  /// The wait from the proof to the end in the second life in a row that is deaf.
  static constexpr double kFirstWait_s = 60.0;
  /// The same of all further ones.
  static constexpr double kNextWait_s = 600.0;
  static constexpr double kReportEvery_s = 60.0;
  /// So long after the service has begun to listen, without a word of the sender, it probes.
  static constexpr double kListen_s = 2.0;
  /// A probe that has heard nothing for so long ends. Meeting takes a second, with security two.
  static constexpr double kProbe_s = 10.0;
  static constexpr double kLongestPause_s = 600.0;

  /// `deaf_lives`: how many lives of the service before this one, in a row, ended deaf.
  explicit RejoinSchedule(std::uint32_t deaf_lives) : deaf_lives_(deaf_lives) {}

  RejoinStep step(const InputState& input, double now_s);

  /// How many there are in a row if this one ends now; 0 once its input has come and is not dead.
  [[nodiscard]] std::uint32_t deaf_lives() const { return deaf_lives_; }

 private:
  static constexpr double kFirstProbe_s = messaging::DeafnessWatch::kSilence_s + kListen_s;

  [[nodiscard]] std::uint32_t lives_before(const InputState& input) const;
  [[nodiscard]] double wait_s(const InputState& input) const;
  void decide_probe(const InputState& input);

  std::uint32_t deaf_lives_;
  bool probes_ = false;
  double probe_since_s_ = 0.0;          // silence when the probe began
  double probe_due_s_ = kFirstProbe_s;  // silence when the next one begins
  bool deaf_ = false;
  double deaf_since_s_ = 0.0;
  double report_due_s_ = 0.0;
};

}  // namespace topogeo::service
