// Looking for the sensor: at which rate and parity does it talk?
#include <algorithm>
#include <string>
#include <utility>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/pls_driver.hpp"

namespace topogeo::devices {
namespace {

/// So much garbage, and not a single stray byte, says that somebody talks at another rate.
constexpr std::uint64_t kGarbage = 8;
/// Pauses are doubled so often at most.
constexpr int kMostDoublings = 20;

std::string name(const LineSettings& line) {
  const char* const parity = line.parity == Parity::kNone   ? "no"
                             : line.parity == Parity::kEven ? "even"
                                                            : "odd";
  return std::to_string(line.baud) + " baud, " + parity + " parity";
}

void add(std::vector<LineSettings>& lines, const LineSettings& line) {
  if (std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
}

}  // namespace

LineSettings PlsDriver::power_on_line() const {
  return {settings_.power_on_baud, known_ ? known_->parity : settings_.parities.front()};
}

/// `listen_first`: at the line that the sensor was heard at last, before anything is asked.
void PlsDriver::start_search(const std::string& reason, bool listen_first, std::int64_t now_ns) {
  exchange_.stop();
  const bool failed = std::max(failed_searches_, failed_setups_) >= settings_.searches_until_failed;
  enter(Phase::kSearch, failed ? PlsState::kFailed : PlsState::kDetecting, reason);
  plan_search();
  if (listen_first && known_) candidates_.insert(candidates_.begin(), *known_);
  candidate_ = 0;
  try_candidate(candidates_.front(), listen_first && known_, now_ns);
}

/// A sensor that was heard before is most likely where it was, or at the rate after power-on if it
/// restarted; it says so only once, so that rate is listened at between all others. The other
/// parity, another kind of sensor, is looked for when the first search was in vain.
void PlsDriver::plan_search() {
  std::vector<LineSettings> all;
  for (const Parity parity : settings_.parities) {
    for (const std::uint32_t baud : settings_.detection_bauds) add(all, {baud, parity});
    add(all, {settings_.power_on_baud, parity});
    add(all, {settings_.baud, parity});
  }
  candidates_ = all;
  if (!known_) return;
  candidates_ = {*known_, power_on_line(), *known_, power_on_line()};
  for (const LineSettings& line : all) {
    if (line == *known_ || line == power_on_line()) continue;
    if (line.parity != known_->parity && failed_searches_ == 0) continue;
    candidates_.push_back(line);
    candidates_.push_back(power_on_line());
  }
}

/// Listens with these settings, and asks the sensor to stop its stream, which it answers in any
/// state, unless the stream is what is hoped for.
void PlsDriver::try_candidate(const LineSettings& line, bool listen_only, std::int64_t now_ns) {
  set_line(line);
  listen_only_ = listen_only;
  candidate_since_ns_ = now_ns;
  last_byte_ns_ = now_ns;
  if (!listen_only) write(pls_mode_command(PlsMode::kOnRequest));
}

void PlsDriver::next_candidate(std::int64_t now_ns) {
  if (++candidate_ < candidates_.size()) {
    try_candidate(candidates_[candidate_], false, now_ns);
    return;
  }
  ++failed_searches_;
  ++status_.counters.searches;
  pause("no answer at any rate, the last was " + name(line_), failed_searches_, now_ns);
}

std::int64_t PlsDriver::search_due_ns() const {
  const std::int64_t asked_ns =
      candidate_since_ns_ + line_time_ns(pls_mode_command(PlsMode::kOnRequest).size(), line_);
  const std::int64_t quiet_ns = std::max(asked_ns, last_byte_ns_) + settings_.detection_quiet_ns;
  // Someone who streams here is heard whole by then, and has answered.
  const std::int64_t whole_ns = asked_ns + 2 * scan_time_ns() + settings_.detection_quiet_ns;
  return std::min(quiet_ns, whole_ns);
}

void PlsDriver::watch_search(std::int64_t now_ns) {
  if (now_ns >= search_due_ns()) next_candidate(now_ns);
}

/// Garbage at one rate is a sensor that talks at another; one that was running may have come back.
void PlsDriver::watch_for_stream(std::int64_t now_ns) {
  if (drops() - drops_before_ < kGarbage) return;
  if (phase_ == Phase::kSearch && known_ && line_ != *known_) {
    try_candidate(*known_, true, now_ns);
  } else if (phase_ == Phase::kPause) {
    start_search(status_.reason, true, now_ns);
  }
}

/// Listens where a sensor that is switched on announces itself.
void PlsDriver::pause(const std::string& reason, int failures, std::int64_t now_ns) {
  exchange_.stop();
  const bool failed = failures >= settings_.searches_until_failed;
  enter(Phase::kPause, failed ? PlsState::kFailed : PlsState::kDetecting, reason);
  set_line(power_on_line());
  const int doublings = std::clamp(failures - 1, 0, kMostDoublings);
  wait_until_ns_ =
      now_ns + std::min(settings_.longest_pause_ns, settings_.first_pause_ns << doublings);
}

/// A telegram proves the settings of the line.
void PlsDriver::found(const SickTelegram& telegram, std::int64_t now_ns) {
  const bool probed = phase_ == Phase::kSearch && !listen_only_;
  // A probe stops the stream, whatever comes before its answer.
  const bool resumed =
      !probed && configured_ && known_ == line_ && settings_.output == PlsOutput::kContinuous;
  if (known_ && known_->parity != line_.parity) maker_.forget();
  known_ = line_;
  failed_searches_ = 0;
  if (resumed && telegram.code == pls_reply::kMeasuredValues) {
    run(now_ns);
    handle_scan(telegram, now_ns);
  } else if (probed && pls_mode_reply(telegram) == PlsModeReply::kDone) {
    after_stop(now_ns);
  } else {
    start_phase(Phase::kStop, now_ns);
  }
}

}  // namespace topogeo::devices
