#include "topogeo/devices/pls_driver.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

/// The longest telegram, a whole scan of 361 beams.
constexpr std::size_t kScan_bytes = 732;

const PlsSettings& checked_laser(const PlsSettings& settings) {
  settings.check();
  return settings;
}

}  // namespace

const char* to_string(PlsState state) {
  switch (state) {
    case PlsState::kOffline:
      return "offline";
    case PlsState::kDetecting:
      return "detecting";
    case PlsState::kConfiguring:
      return "configuring";
    case PlsState::kRunning:
      return "running";
    case PlsState::kFailed:
      return "failed";
  }
  return "unknown";
}

PlsDriver::PlsDriver(PlsSettings settings)
    : settings_(std::move(settings)),
      decoder_(SickDecoder::Listener::kHost, checked_laser(settings_).byte_gap_ns),
      maker_(settings_) {}

void PlsDriver::opened(std::int64_t now_ns) {
  ++status_.counters.openings;
  failed_searches_ = 0;
  failed_setups_ = 0;
  // Nobody knows how the port is set, so the first order says it even if nothing seems to change.
  line_ = known_.value_or(power_on_line());
  decoder_.clear();
  orders_.push_back({line_, {}});
  start_search("the port was opened", configured_, now_ns);
}

void PlsDriver::lost(std::int64_t /*now_ns*/) {
  exchange_.stop();
  decoder_.clear();
  orders_.clear();
  enter(Phase::kOffline, PlsState::kOffline, "the port is closed");
}

void PlsDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (phase_ == Phase::kOffline || bytes.empty()) return;
  last_byte_ns_ = now_ns;
  decoder_.push(bytes, now_ns);
  handle_events(now_ns);
  watch_for_stream(now_ns);
}

void PlsDriver::tick(std::int64_t now_ns) {
  if (phase_ == Phase::kOffline) return;
  decoder_.tick(now_ns);
  handle_events(now_ns);
  watch_for_stream(now_ns);
  if (exchange_.open()) {
    exchange_.tick(now_ns);
    flush_exchange();
    if (!exchange_.open()) go_on(now_ns);
  }
  if (phase_ == Phase::kSearch) watch_search(now_ns);
  if (phase_ == Phase::kRun) watch_run(now_ns);
  if (phase_ == Phase::kPause && now_ns >= wait_until_ns_)
    start_search(status_.reason, false, now_ns);
  if (phase_ == Phase::kSettle && now_ns >= wait_until_ns_) start_phase(Phase::kProve, now_ns);
}

std::int64_t PlsDriver::due_ns() const {
  std::int64_t due_ns = std::min(decoder_.due_ns(), exchange_.due_ns());
  switch (phase_) {
    case Phase::kOffline:
      return std::numeric_limits<std::int64_t>::max();
    case Phase::kSearch:
      return std::min(due_ns, search_due_ns());
    case Phase::kPause:
    case Phase::kSettle:
      return std::min(due_ns, wait_until_ns_);
    case Phase::kRun:
      due_ns = std::min(due_ns, silent_at_ns());
      if (settings_.output == PlsOutput::kOnRequest && !exchange_.open()) {
        due_ns = std::min(due_ns, wait_until_ns_);
      }
      return due_ns;
    default:
      return due_ns;
  }
}

std::vector<LineOrder> PlsDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<PlsScan> PlsDriver::take_scans() {
  return std::exchange(scans_, {});
}

PlsStatus PlsDriver::status() const {
  PlsStatus status = status_;
  status.line = line_;
  status.lms = lms();
  status.stuck = maker_.stuck();
  if (status.state == PlsState::kRunning) {
    status.reason = status.stuck ? "the same scan comes again and again" : fallback_;
  }
  status.counters.line = decoder_.counters();
  status.counters.scan_drops = maker_.drops();
  status.counters.timeouts = exchange_.timeouts();
  status.counters.repeats = exchange_.repeats();
  status.counters.refusals = exchange_.refusals();
  return status;
}

void PlsDriver::handle_events(std::int64_t now_ns) {
  while (const std::optional<SickEvent> event = decoder_.next()) {
    switch (event->kind) {
      case SickEvent::Kind::kAck:
        exchange_.acknowledged(now_ns);
        break;
      case SickEvent::Kind::kNak:
        exchange_.refused(now_ns);
        if (phase_ != Phase::kSearch && !exchange_.open()) go_on(now_ns);
        break;
      case SickEvent::Kind::kTelegram:
        handle_telegram(event->telegram, now_ns);
        break;
    }
  }
}

void PlsDriver::handle_telegram(const SickTelegram& telegram, std::int64_t now_ns) {
  note(telegram);
  if (telegram.code == pls_reply::kPowerOn) {
    handle_power_on(telegram, now_ns);
  } else if (phase_ == Phase::kSearch || phase_ == Phase::kPause) {
    found(telegram, now_ns);
  } else if (telegram.code == pls_reply::kReset) {
    configured_ = false;
    start_search("the sensor restarts", false, now_ns);
  } else {
    if (telegram.code == pls_reply::kMeasuredValues) handle_scan(telegram, now_ns);
    handle_reply(telegram, now_ns);
  }
}

/// Keeps what the telegram says of the sensor.
void PlsDriver::note(const SickTelegram& telegram) {
  status_.health = pls_health(telegram.status);
  if (const auto text = pls_power_on_text(telegram)) status_.power_on_text = *text;
  if (const auto report = pls_status_report(telegram)) status_.software = report->software;
  if (auto errors = pls_errors(telegram)) status_.errors = std::move(*errors);
}

void PlsDriver::handle_power_on(const SickTelegram& telegram, std::int64_t now_ns) {
  ++status_.counters.restarts;
  configured_ = false;
  failed_switches_ = 0;
  fallback_.clear();
  found(telegram, now_ns);
}

void PlsDriver::handle_scan(const SickTelegram& telegram, std::int64_t now_ns) {
  if (phase_ != Phase::kRun) {
    ++status_.counters.unsolicited;
    return;
  }
  const std::optional<PlsMeasuredValues> values = pls_measured_values(telegram);
  if (!values) return;
  last_scan_ns_ = now_ns;
  failed_setups_ = 0;
  if (std::optional<PlsScan> scan = maker_.make(*values, telegram, line_)) {
    ++status_.counters.scans;
    scans_.push_back(std::move(*scan));
  }
}

void PlsDriver::handle_reply(const SickTelegram& telegram, std::int64_t now_ns) {
  if (!exchange_.open()) return;
  if (telegram.code == pls_reply::kNotAcknowledged) {
    exchange_.refused(now_ns);
  } else if (telegram.code == exchange_.code()) {
    exchange_.replied(pls_mode_reply(telegram));
  }
  if (!exchange_.open()) go_on(now_ns);
}

void PlsDriver::set_line(const LineSettings& line) {
  drops_before_ = drops();
  if (line == line_) return;
  line_ = line;
  decoder_.clear();
  orders_.push_back({line_, {}});
}

void PlsDriver::write(std::vector<std::uint8_t> bytes) {
  orders_.push_back({std::nullopt, std::move(bytes)});
}

void PlsDriver::flush_exchange() {
  if (auto command = exchange_.take_command()) write(std::move(*command));
}

void PlsDriver::enter(Phase phase, PlsState state, std::string reason) {
  phase_ = phase;
  status_.state = state;
  status_.reason = std::move(reason);
}

/// What the decoder dropped so far, as one number that grows with any garbage.
std::uint64_t PlsDriver::drops() const {
  const SickCounters& counters = decoder_.counters();
  return counters.bad_crc + counters.implausible_length + counters.truncated + counters.noise_bytes;
}

std::int64_t PlsDriver::scan_time_ns() const {
  return line_time_ns(kScan_bytes, line_);
}

std::int64_t PlsDriver::silence_ns() const {
  const std::int64_t period_ns = std::max(settings_.scan_period_ns, scan_time_ns());
  return std::max(settings_.shortest_silence_ns, settings_.silent_scan_periods * period_ns);
}

}  // namespace topogeo::devices
