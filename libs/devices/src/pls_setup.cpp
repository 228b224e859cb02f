#include "topogeo/devices/pls_setup.hpp"

#include <limits>
#include <utility>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {

namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
/// Use at another rate than wanted before the next try, doubled each time. A try costs a second of
/// scans, so a sensor that never follows gets no more than these.
constexpr std::int64_t kFirstUse_ns = 15'000'000'000;
constexpr int kMostRetries = 6;

}  // namespace

void PlsSetup::begin(Step step, std::int64_t now_ns) {
  step_ = step;
  reason_ = name(step);
  line_.ask(exchange_, command(step), limits(step), now_ns);
}

std::string PlsSetup::name(Step step) const {
  switch (step) {
    case Step::kStop:
      return "stops the stream";
    case Step::kInstall:
      return "requests installation mode";
    case Step::kRate:
      return "requests " + std::to_string(settings_.baud) + " baud";
    case Step::kSettle:
      return "waits after the change to " + std::to_string(settings_.baud) + " baud";
    case Step::kProve:
      return "checks the line at " + std::to_string(line_.settings().baud) + " baud";
    case Step::kStatus:
      return "requests the status";
    case Step::kErrors:
      return "requests the errors";
    case Step::kMonitor:
      break;
  }
  return "requests scans";
}

std::vector<std::uint8_t> PlsSetup::command(Step step) const {
  switch (step) {
    case Step::kInstall:
      return pls_mode_command(PlsMode::kInstallation, settings_.password_pls);
    case Step::kRate:
      return pls_baud_command(settings_.baud).value();
    case Step::kStatus:
      return sick_command(pls_command::kRequestStatus);
    case Step::kErrors:
      return sick_command(pls_command::kRequestErrors);
    case Step::kMonitor:
      return pls_mode_command(settings_.output == PlsOutput::kContinuous ? PlsMode::kStream
                                                                         : PlsMode::kOnRequest);
    default:
      return pls_mode_command(PlsMode::kOnRequest);
  }
}

SickExchange::Limits PlsSetup::limits(Step step) const {
  SickExchange::Limits limits{settings_.ack_timeout_ns, settings_.reply_timeout_ns,
                              settings_.repeat_gap_ns, settings_.tries};
  // The present scan and the next one, which is ready, may come before the answer.
  if (step == Step::kStop) limits.ack_timeout_ns += 2 * line_.scan_time_ns();
  if (step == Step::kRate) {
    // If the sensor heard the first command, a second one at the old rate would be garbage.
    limits.repeat_unanswered = false;
    limits.reply_timeout_ns = settings_.baud_reply_timeout_ns;
  }
  return limits;
}

bool PlsSetup::replied() const {
  return exchange_.result() == SickExchange::Result::kReplied;
}

PlsSetup::Result PlsSetup::go_on(std::int64_t now_ns) {
  switch (step_) {
    case Step::kStop:
      return replied() ? after_stop(now_ns) : fail("the sensor does not stop its stream");
    case Step::kInstall:
      return after_install(now_ns);
    case Step::kRate:
      return after_rate(now_ns);
    case Step::kProve:
      return after_prove(now_ns);
    case Step::kStatus:
      begin(Step::kErrors, now_ns);
      break;
    case Step::kErrors:
      begin(Step::kMonitor, now_ns);
      break;
    case Step::kMonitor:
      return after_monitor();
    case Step::kSettle:
      break;
  }
  return Result::kGoesOn;
}

void PlsSetup::start_stopped(std::int64_t now_ns) {
  (void)after_stop(now_ns);
}

PlsSetup::Result PlsSetup::after_stop(std::int64_t now_ns) {
  const bool wanted_rate = line_.settings().baud == settings_.baud;
  if (wanted_rate) {
    fallback_.clear();
    retry_at_ns_ = kNever;
    fallbacks_ = 0;
  }
  if (wanted_rate || !fallback_.empty()) {
    begin(Step::kStatus, now_ns);
  } else if (failed_switches_ >= settings_.baud_switch_tries) {
    return fall_back("the sensor does not switch to " + std::to_string(settings_.baud) + " baud",
                     now_ns);
  } else {
    ask_for_rate(now_ns);
  }
  return Result::kGoesOn;
}

/// An LMS changes its rate in any mode.
void PlsSetup::ask_for_rate(std::int64_t now_ns) {
  begin(line_.lms() ? Step::kRate : Step::kInstall, now_ns);
}

PlsSetup::Result PlsSetup::after_install(std::int64_t now_ns) {
  if (!replied()) return fail("no answer to the request for installation mode");
  if (exchange_.mode_reply() != PlsModeReply::kDone) {
    return fall_back("the password is refused", now_ns);
  }
  begin(Step::kRate, now_ns);
  return Result::kGoesOn;
}

PlsSetup::Result PlsSetup::after_rate(std::int64_t now_ns) {
  const bool refused = exchange_.result() == SickExchange::Result::kRefused ||
                       (replied() && exchange_.mode_reply() != PlsModeReply::kDone);
  if (refused && ++refused_rates_ < settings_.baud_switch_tries) {
    // A late answer to a repeated request may have counted as that to the request for installation
    // mode, which the sensor ignored while it gave it.
    ask_for_rate(now_ns);
    return Result::kGoesOn;
  }
  if (refused) {
    return fall_back("the sensor refuses " + std::to_string(settings_.baud) + " baud", now_ns);
  }
  // Some sensors answer at the old rate, some perhaps at the new one: without an answer only a try
  // shows the rate.
  line_.set({settings_.baud, line_.settings().parity});
  step_ = Step::kSettle;
  reason_ = name(step_);
  settled_ns_ = now_ns + settings_.settle_ns;
  return Result::kGoesOn;
}

PlsSetup::Result PlsSetup::after_prove(std::int64_t now_ns) {
  if (!replied()) {
    ++failed_switches_;
    reason_ = "the sensor did not switch to " + std::to_string(settings_.baud) + " baud";
    return Result::kNotFollowed;
  }
  line_.heard();
  retry_rate();
  refused_rates_ = 0;
  fallbacks_ = 0;
  begin(Step::kStatus, now_ns);
  return Result::kGoesOn;
}

PlsSetup::Result PlsSetup::after_monitor() {
  if (replied() && exchange_.mode_reply() == PlsModeReply::kDone) return Result::kDone;
  return fail("the sensor does not send scans");
}

/// Uses the sensor at its present rate.
PlsSetup::Result PlsSetup::fall_back(const std::string& why, std::int64_t now_ns) {
  fallback_ = "runs at " + std::to_string(line_.settings().baud) + " baud: " + why;
  retry_at_ns_ = fallbacks_ < kMostRetries ? now_ns + (kFirstUse_ns << fallbacks_) : kNever;
  ++fallbacks_;
  refused_rates_ = 0;
  begin(Step::kStatus, now_ns);
  return Result::kGoesOn;
}

PlsSetup::Result PlsSetup::fail(std::string reason) {
  ++failures_;
  reason_ = std::move(reason);
  return Result::kFailed;
}

void PlsSetup::retry_rate() {
  failed_switches_ = 0;
  fallback_.clear();
  retry_at_ns_ = kNever;
}

void PlsSetup::tick(std::int64_t now_ns) {
  if (now_ns >= due_ns()) begin(Step::kProve, now_ns);
}

std::int64_t PlsSetup::due_ns() const {
  return step_ == Step::kSettle ? settled_ns_ : kNever;
}

}  // namespace topogeo::devices
