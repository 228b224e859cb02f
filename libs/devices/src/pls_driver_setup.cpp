// Setting up a sensor that was found: stream off, rate, questions, stream on; and watching it run.
#include <algorithm>
#include <string>
#include <utility>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/pls_driver.hpp"

namespace topogeo::devices {
namespace {

std::string runs_at(std::uint32_t baud) {
  return "runs at " + std::to_string(baud) + " baud: ";
}

}  // namespace

void PlsDriver::start_phase(Phase phase, std::int64_t now_ns) {
  switch (phase) {
    case Phase::kStop:
      enter(phase, PlsState::kConfiguring, "stops the stream");
      ask(pls_mode_command(PlsMode::kOnRequest), now_ns);
      break;
    case Phase::kInstall:
      enter(phase, PlsState::kConfiguring, "asks for installation mode");
      ask(pls_mode_command(PlsMode::kInstallation, settings_.password_pls), now_ns);
      break;
    case Phase::kRate:
      enter(phase, PlsState::kConfiguring, "asks for " + std::to_string(settings_.baud) + " baud");
      ask(pls_baud_command(settings_.baud).value(), now_ns);
      break;
    case Phase::kProve:
      enter(phase, PlsState::kConfiguring,
            "asks for an answer at " + std::to_string(line_.baud) + " baud");
      ask(pls_mode_command(PlsMode::kOnRequest), now_ns);
      break;
    case Phase::kStatus:
      enter(phase, PlsState::kConfiguring, "asks for the status");
      ask(sick_command(pls_command::kRequestStatus), now_ns);
      break;
    case Phase::kErrors:
      enter(phase, PlsState::kConfiguring, "asks for the errors");
      ask(sick_command(pls_command::kRequestErrors), now_ns);
      break;
    default:
      enter(Phase::kMonitor, PlsState::kConfiguring, "asks for scans");
      ask(pls_mode_command(settings_.output == PlsOutput::kContinuous ? PlsMode::kStream
                                                                      : PlsMode::kOnRequest),
          now_ns);
      break;
  }
}

/// Sends the command of the present phase, with the limits that suit it.
void PlsDriver::ask(std::vector<std::uint8_t> command, std::int64_t now_ns) {
  SickExchange::Limits limits{settings_.ack_timeout_ns, settings_.reply_timeout_ns,
                              settings_.repeat_gap_ns, settings_.tries};
  // The scan that is being sent, and the next that is ready, may come before the answer.
  if (phase_ == Phase::kStop) limits.ack_timeout_ns += 2 * scan_time_ns();
  if (phase_ == Phase::kRate) {
    // After a first command that may have been heard, a second one at the old rate may be garbage.
    limits.repeat_unanswered = false;
    limits.reply_timeout_ns = settings_.baud_reply_timeout_ns;
  }
  if (phase_ == Phase::kRun) {
    limits.tries = 1;
    limits.ack_timeout_ns += scan_time_ns();
    limits.reply_timeout_ns =
        2 * settings_.scan_period_ns + scan_time_ns() + settings_.ack_timeout_ns;
  }
  exchange_.start(std::move(command), limits, line_, now_ns);
  flush_exchange();
}

/// What was asked for is answered, or was in vain.
void PlsDriver::go_on(std::int64_t now_ns) {
  switch (phase_) {
    case Phase::kStop:
      if (exchange_.result() == SickExchange::Result::kReplied) {
        after_stop(now_ns);
      } else {
        give_up("the sensor does not stop its stream", now_ns);
      }
      break;
    case Phase::kInstall:
      after_install(now_ns);
      break;
    case Phase::kRate:
      after_rate(now_ns);
      break;
    case Phase::kProve:
      after_prove(now_ns);
      break;
    case Phase::kStatus:
      start_phase(Phase::kErrors, now_ns);
      break;
    case Phase::kErrors:
      start_phase(Phase::kMonitor, now_ns);
      break;
    case Phase::kMonitor:
      after_monitor(now_ns);
      break;
    case Phase::kRun:
      after_request(now_ns);
      break;
    default:
      break;
  }
}

void PlsDriver::after_stop(std::int64_t now_ns) {
  if (line_.baud == settings_.baud) fallback_.clear();
  if (line_.baud == settings_.baud || !fallback_.empty()) {
    start_phase(Phase::kStatus, now_ns);
  } else if (failed_switches_ >= settings_.baud_switch_tries) {
    fallback_ = runs_at(line_.baud) + "the sensor does not follow to " +
                std::to_string(settings_.baud) + " baud";
    start_phase(Phase::kStatus, now_ns);
  } else {
    // An LMS changes its rate in any mode.
    start_phase(lms() ? Phase::kRate : Phase::kInstall, now_ns);
  }
}

void PlsDriver::after_install(std::int64_t now_ns) {
  if (exchange_.result() != SickExchange::Result::kReplied) {
    give_up("no answer to the call for installation mode", now_ns);
  } else if (exchange_.mode_reply() == PlsModeReply::kDone) {
    start_phase(Phase::kRate, now_ns);
  } else {
    fallback_ = runs_at(line_.baud) + "the password is refused";
    start_phase(Phase::kStatus, now_ns);
  }
}

void PlsDriver::after_rate(std::int64_t now_ns) {
  const SickExchange::Result result = exchange_.result();
  if (result == SickExchange::Result::kRefused ||
      (result == SickExchange::Result::kReplied && exchange_.mode_reply() != PlsModeReply::kDone)) {
    fallback_ =
        runs_at(line_.baud) + "the sensor refuses " + std::to_string(settings_.baud) + " baud";
    start_phase(Phase::kStatus, now_ns);
    return;
  }
  // Some answer at the old rate, some perhaps at the new one: without an answer only trying tells.
  set_line({settings_.baud, line_.parity});
  enter(Phase::kSettle, PlsState::kConfiguring,
        "rests after the change to " + std::to_string(settings_.baud) + " baud");
  wait_until_ns_ = now_ns + settings_.settle_ns;
}

void PlsDriver::after_prove(std::int64_t now_ns) {
  if (exchange_.result() == SickExchange::Result::kReplied) {
    known_ = line_;
    failed_switches_ = 0;
    fallback_.clear();
    start_phase(Phase::kStatus, now_ns);
    return;
  }
  ++failed_switches_;
  ++status_.counters.switches_not_followed;
  start_search("the sensor did not follow to " + std::to_string(settings_.baud) + " baud", false,
               now_ns);
}

void PlsDriver::after_monitor(std::int64_t now_ns) {
  if (exchange_.result() == SickExchange::Result::kReplied &&
      exchange_.mode_reply() == PlsModeReply::kDone) {
    run(now_ns);
  } else {
    give_up("the sensor does not send scans", now_ns);
  }
}

void PlsDriver::after_request(std::int64_t now_ns) {
  const bool replied = exchange_.result() == SickExchange::Result::kReplied;
  if (!replied) wait_until_ns_ = std::max(wait_until_ns_, now_ns + settings_.repeat_gap_ns);
}

/// The first time it may have been a disturbance; after that the sensor gets a rest.
void PlsDriver::give_up(const std::string& reason, std::int64_t now_ns) {
  if (++failed_setups_ == 1) {
    start_search(reason, false, now_ns);
  } else {
    pause(reason, failed_setups_, now_ns);
  }
}

void PlsDriver::run(std::int64_t now_ns) {
  exchange_.stop();
  enter(Phase::kRun, PlsState::kRunning, {});
  configured_ = true;
  last_scan_ns_ = now_ns;
  wait_until_ns_ = now_ns;
  watch_run(now_ns);
}

/// A sensor whose scans come damaged is heard all the same, and is waited for three times as long.
std::int64_t PlsDriver::silent_at_ns() const {
  const std::int64_t heard_until_ns =
      std::min(last_byte_ns_ + settings_.detection_quiet_ns, last_scan_ns_ + 3 * silence_ns());
  return std::max(last_scan_ns_ + silence_ns(), heard_until_ns);
}

void PlsDriver::watch_run(std::int64_t now_ns) {
  if (now_ns >= silent_at_ns()) {
    ++status_.counters.silences;
    // It may have restarted without being heard, and may follow to another rate now.
    failed_switches_ = 0;
    fallback_.clear();
    start_search("no scan for " + std::to_string((now_ns - last_scan_ns_) / 1'000'000) + " ms",
                 false, now_ns);
    return;
  }
  const bool on_request = settings_.output == PlsOutput::kOnRequest;
  if (on_request && !exchange_.open() && now_ns >= wait_until_ns_) {
    wait_until_ns_ = now_ns + settings_.scan_period_ns;
    ask(pls_scan_request(), now_ns);
  }
}

}  // namespace topogeo::devices
