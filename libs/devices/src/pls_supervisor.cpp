#include "topogeo/devices/pls_supervisor.hpp"

#include <algorithm>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

/// Waits this many times longer for a sensor whose scans arrive damaged, because a disturbance of
/// the line is likelier than a change of its rate.
constexpr std::int64_t kDamagedPatience = 3;

}  // namespace

void PlsSupervisor::start(std::int64_t now_ns) {
  last_scan_ns_ = now_ns;
  next_request_ns_ = now_ns;
}

void PlsSupervisor::request_ended(std::int64_t now_ns) {
  if (exchange_.result() == SickExchange::Result::kReplied) return;
  next_request_ns_ = std::max(next_request_ns_, now_ns + settings_.repeat_gap_ns);
}

std::int64_t PlsSupervisor::patience_ns() const {
  const std::int64_t period_ns = std::max(settings_.scan_period_ns, line_.scan_time_ns());
  return std::max(settings_.shortest_silence_ns, settings_.silent_scan_periods * period_ns);
}

std::int64_t PlsSupervisor::silent_at_ns() const {
  const std::int64_t heard_until_ns = std::min(line_.last_byte_ns() + settings_.detection_quiet_ns,
                                               last_scan_ns_ + kDamagedPatience * patience_ns());
  return std::max(last_scan_ns_ + patience_ns(), heard_until_ns);
}

bool PlsSupervisor::may_ask() const {
  return settings_.output == PlsOutput::kOnRequest && !exchange_.open();
}

void PlsSupervisor::tick(std::int64_t now_ns) {
  if (!may_ask() || now_ns < next_request_ns_) return;
  next_request_ns_ = now_ns + settings_.scan_period_ns;
  SickExchange::Limits limits;
  limits.ack_timeout_ns = settings_.ack_timeout_ns + line_.scan_time_ns();
  limits.reply_timeout_ns =
      2 * settings_.scan_period_ns + line_.scan_time_ns() + settings_.ack_timeout_ns;
  limits.repeat_gap_ns = settings_.repeat_gap_ns;
  limits.tries = 1;
  line_.ask(exchange_, pls_scan_request(), limits, now_ns);
}

std::int64_t PlsSupervisor::due_ns() const {
  const std::int64_t silent_ns = silent_at_ns();
  return may_ask() ? std::min(silent_ns, next_request_ns_) : silent_ns;
}

}  // namespace topogeo::devices
