#include "input_delays.hpp"

#include <string_view>
#include <utility>

#include "topogeo/support/format.hpp"

#include "elapsed.hpp"

namespace topogeo::navigation {
namespace {

/// The input that a reason refers to.
std::optional<TimedInput> input_of(HaltReason reason) {
  switch (reason) {
    case HaltReason::kNoOdometry:
      return TimedInput::kOdometry;
    case HaltReason::kNoScan:
      return TimedInput::kScan;
    case HaltReason::kSonarSilent:
      return TimedInput::kSonar;
    case HaltReason::kPoseLost:
      return TimedInput::kPose;
    default:
      return std::nullopt;
  }
}

std::string_view plural_of(TimedInput input) {
  switch (input) {
    case TimedInput::kPose:
      return "poses arrive";
    case TimedInput::kOdometry:
      return "odometry arrives";
    case TimedInput::kScan:
      return "scans arrive";
    case TimedInput::kSonar:
      return "readings of the sonars arrive";
  }
  return "inputs arrive";
}

/// Whether an overloaded machine can cause the reason. It cannot cause people's orders and
/// obstacles.
bool may_be_busy(HaltReason reason) {
  switch (reason) {
    case HaltReason::kNoOdometry:
    case HaltReason::kNoScan:
    case HaltReason::kSonarSilent:
    case HaltReason::kPoseLost:
    case HaltReason::kNoMap:
    case HaltReason::kWaitsForRoute:
    case HaltReason::kBaseNotReady:
    case HaltReason::kBaseStuck:
      return true;
    default:
      return false;
  }
}

}  // namespace

void InputDelays::add(TimedInput input, std::int64_t stamp_ns, std::int64_t arrival_ns) {
  newest_.at(static_cast<std::size_t>(input)) = Newest{stamp_ns, arrival_ns};
}

/// Nothing for an input that has ceased, never came or is in time.
std::optional<double> InputDelays::delay_s(TimedInput input, std::int64_t now_ns) const {
  constexpr double kStillComes_s = 1.0;  // the slowest input comes four times a second
  // Half of the navigator's limits with the usual settings, because the rest passes between two
  // messages.
  const double least_s = input == TimedInput::kPose ? 1.5 : 0.3;
  const std::optional<Newest>& newest = newest_.at(static_cast<std::size_t>(input));
  if (!newest || elapsed_s(newest->arrival_ns, now_ns) > kStillComes_s) return std::nullopt;
  const double delay_s = elapsed_s(newest->stamp_ns, newest->arrival_ns);
  if (delay_s < least_s) return std::nullopt;
  return delay_s;
}

InputDelays::Reason InputDelays::explain(HaltReason reason, std::string message,
                                         std::int64_t now_ns) const {
  if (const std::optional<TimedInput> input = input_of(reason)) {
    if (const std::optional<double> late_s = delay_s(*input, now_ns)) {
      const std::string what = fmt::format("{} {:.1f} s late", plural_of(*input), *late_s);
      std::string text = load_.busy
                             ? "this machine is too busy: " + what
                             : what + ": the machine that sends them or the network is too busy";
      // A pose may be missing for other reasons too, and so may echoes of sonars.
      const bool whole = reason == HaltReason::kNoScan || reason == HaltReason::kNoOdometry;
      return {whole ? std::move(text) : message + "; " + text, true};
    }
  }
  if (!load_.busy || !may_be_busy(reason)) return {std::move(message), false};
  return {fmt::format("{}; this machine is too busy: timers fire up to {:.1f} s late", message,
                      load_.timer_delay_s),
          true};
}

}  // namespace topogeo::navigation
