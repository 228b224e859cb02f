#include "topogeo/devices/pls_driver.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kNsPerMs = 1'000'000;

PlsSettings checked_laser(PlsSettings settings) {
  settings.check();
  return settings;
}

}  // namespace

PlsDriver::PlsDriver(PlsSettings settings)
    : settings_(checked_laser(std::move(settings))),
      line_(settings_),
      maker_(settings_),
      search_(settings_, line_),
      setup_(settings_, line_, exchange_),
      supervisor_(settings_, line_, exchange_) {}

void PlsDriver::resume(const LineSettings& line) {
  line_.expect(line);
  // If the sensor has another rate than wanted, it is set up anew, because it may follow now.
  configured_ = line.baud == settings_.baud;
}

void PlsDriver::opened(std::int64_t now_ns) {
  ++status_.counters.openings;
  search_.reset();
  setup_.reset();
  line_.open();
  search("the port was opened", configured_, now_ns);
}

void PlsDriver::lost(std::int64_t /*now_ns*/) {
  exchange_.stop();
  line_.close();
  enter(Phase::kOffline, PlsState::kOffline, "the port is closed");
}

void PlsDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (phase_ == Phase::kOffline || bytes.empty()) return;
  line_.receive(bytes, now_ns);
  take_events(now_ns);
  follow_garbage(now_ns);
}

void PlsDriver::tick(std::int64_t now_ns) {
  if (phase_ == Phase::kOffline) return;
  line_.decoder().tick(now_ns);
  take_events(now_ns);
  follow_garbage(now_ns);
  if (exchange_.open()) {
    exchange_.tick(now_ns);
    line_.write(exchange_);
    if (!exchange_.open()) exchange_ended(now_ns);
  }
  if (phase_ == Phase::kSearch && !search_.tick(now_ns)) {
    ++status_.counters.searches;
    rest("no answer at any baud rate, last tried " + line_name(line_.settings()),
         search_.failures(), now_ns);
  }
  if (phase_ == Phase::kRun) supervise(now_ns);
  if (phase_ == Phase::kRest && now_ns >= search_.rested_ns()) {
    search(status_.reason, false, now_ns);
  }
  if (phase_ == Phase::kSetUp) {
    setup_.tick(now_ns);
    enter_setup();
  }
}

std::int64_t PlsDriver::due_ns() const {
  const std::int64_t due_ns = std::min(line_.decoder().due_ns(), exchange_.due_ns());
  switch (phase_) {
    case Phase::kOffline:
      break;
    case Phase::kSearch:
      return std::min(due_ns, search_.due_ns());
    case Phase::kRest:
      return std::min(due_ns, search_.rested_ns());
    case Phase::kSetUp:
      return std::min(due_ns, setup_.due_ns());
    case Phase::kRun:
      return std::min({due_ns, supervisor_.due_ns(), setup_.retry_at_ns()});
  }
  return std::numeric_limits<std::int64_t>::max();
}

std::vector<LineOrder> PlsDriver::take_orders() {
  return line_.take_orders();
}

std::vector<LaserScan> PlsDriver::take_scans() {
  return std::exchange(scans_, {});
}

PlsStatus PlsDriver::status() const {
  PlsStatus status = status_;
  status.line = line_.settings();
  status.lms = line_.lms();
  status.stuck = maker_.stuck();
  if (status.state == PlsState::kRunning) {
    status.reason = status.stuck ? "the sensor repeats the same scan" : setup_.fallback();
  }
  status.counters.line = line_.decoder().counters();
  status.counters.scan_drops = maker_.drops();
  status.counters.timeouts = exchange_.timeouts();
  status.counters.repeats = exchange_.repeats();
  status.counters.refusals = exchange_.refusals();
  return status;
}

LaserHealth PlsDriver::health() const {
  return laser_health(status());
}

void PlsDriver::take_events(std::int64_t now_ns) {
  while (const std::optional<SickEvent> event = line_.decoder().next()) {
    switch (event->kind) {
      case SickEvent::Kind::kAck:
        exchange_.acknowledged(now_ns);
        break;
      case SickEvent::Kind::kNak:
        exchange_.refused(now_ns);
        if (!exchange_.open()) exchange_ended(now_ns);
        break;
      case SickEvent::Kind::kTelegram:
        take(event->telegram, now_ns);
        break;
    }
  }
}

void PlsDriver::take(const SickTelegram& telegram, std::int64_t now_ns) {
  note(telegram);
  if (telegram.code == pls_reply::kPowerOn) {
    take_power_on(telegram, now_ns);
  } else if (phase_ == Phase::kSearch || phase_ == Phase::kRest) {
    found(telegram, now_ns);
  } else if (telegram.code == pls_reply::kReset) {
    configured_ = false;
    search("the sensor restarts", false, now_ns);
  } else {
    if (telegram.code == pls_reply::kMeasuredValues) take_scan(telegram, now_ns);
    take_reply(telegram, now_ns);
  }
}

/// Stores the sensor's data from the telegram.
void PlsDriver::note(const SickTelegram& telegram) {
  status_.health = pls_health(telegram.status);
  if (const auto text = pls_power_on_text(telegram)) status_.power_on_text = *text;
  if (const auto report = pls_status_report(telegram)) status_.software = report->software;
  if (auto errors = pls_errors(telegram)) status_.errors = std::move(*errors);
}

void PlsDriver::take_power_on(const SickTelegram& telegram, std::int64_t now_ns) {
  ++status_.counters.restarts;
  configured_ = false;
  setup_.retry_rate();
  found(telegram, now_ns);
}

void PlsDriver::take_scan(const SickTelegram& telegram, std::int64_t now_ns) {
  if (phase_ != Phase::kRun) {
    ++status_.counters.unsolicited;
    return;
  }
  const std::optional<PlsMeasuredValues> values = pls_measured_values(telegram);
  if (!values) return;
  supervisor_.scan_came(now_ns);
  setup_.reset();
  if (std::optional<LaserScan> scan = maker_.make(*values, telegram, line_.settings())) {
    ++status_.counters.scans;
    scans_.push_back(std::move(*scan));
  }
}

void PlsDriver::take_reply(const SickTelegram& telegram, std::int64_t now_ns) {
  if (!exchange_.open()) return;
  if (telegram.code == pls_reply::kNotAcknowledged) {
    exchange_.refused(now_ns);
  } else if (telegram.code == exchange_.code()) {
    exchange_.replied(pls_mode_reply(telegram));
  }
  if (!exchange_.open()) exchange_ended(now_ns);
}

/// The exchange ended with or without an answer.
void PlsDriver::exchange_ended(std::int64_t now_ns) {
  if (phase_ == Phase::kRun) return supervisor_.request_ended(now_ns);
  if (phase_ != Phase::kSetUp) return;
  switch (setup_.go_on(now_ns)) {
    case PlsSetup::Result::kGoesOn:
      enter_setup();
      break;
    case PlsSetup::Result::kDone:
      run(now_ns);
      break;
    case PlsSetup::Result::kNotFollowed:
      ++status_.counters.switches_not_followed;
      search(setup_.reason(), false, now_ns);
      break;
    case PlsSetup::Result::kFailed:
      // The first failure may be a disturbance; after further ones the sensor gets a rest.
      if (setup_.failures() == 1) {
        search(setup_.reason(), false, now_ns);
      } else {
        rest(setup_.reason(), setup_.failures(), now_ns);
      }
      break;
  }
}

/// `listen_first`: listens where the sensor was heard last before asking.
void PlsDriver::search(const std::string& reason, bool listen_first, std::int64_t now_ns) {
  exchange_.stop();
  enter_search(Phase::kSearch, std::max(search_.failures(), setup_.failures()), reason);
  search_.start(listen_first, now_ns);
}

void PlsDriver::rest(const std::string& reason, int failures, std::int64_t now_ns) {
  exchange_.stop();
  enter_search(Phase::kRest, failures, reason);
  search_.rest(failures, now_ns);
}

void PlsDriver::follow_garbage(std::int64_t now_ns) {
  if (!search_.hears_garbage()) return;
  if (phase_ == Phase::kSearch) {
    search_.follow_garbage(now_ns);
  } else if (phase_ == Phase::kRest) {
    search(status_.reason, true, now_ns);
  }
}

/// A telegram came over the present line.
void PlsDriver::found(const SickTelegram& telegram, std::int64_t now_ns) {
  const std::optional<LineSettings> known = line_.known();
  const bool asked = phase_ == Phase::kSearch && search_.asked();
  // A question stops the stream, even if scans arrive before its answer.
  const bool streams = !asked && configured_ && known == line_.settings() &&
                       settings_.output == PlsOutput::kContinuous;
  if (known && known->parity != line_.settings().parity) maker_.forget();
  line_.heard();
  search_.reset();
  if (streams && telegram.code == pls_reply::kMeasuredValues) {
    run(now_ns);
    take_scan(telegram, now_ns);
    return;
  }
  if (asked && pls_mode_reply(telegram) == PlsModeReply::kDone) {
    setup_.start_stopped(now_ns);
  } else {
    setup_.start(now_ns);
  }
  enter_setup();
}

void PlsDriver::run(std::int64_t now_ns) {
  exchange_.stop();
  enter(Phase::kRun, PlsState::kRunning, {});
  configured_ = true;
  supervisor_.start(now_ns);
  supervise(now_ns);
}

void PlsDriver::supervise(std::int64_t now_ns) {
  if (now_ns >= setup_.retry_at_ns()) {
    const std::string reason = "tries another rate: " + setup_.fallback();
    setup_.retry_rate();
    return search(reason, false, now_ns);
  }
  if (!supervisor_.silent(now_ns)) return supervisor_.tick(now_ns);
  ++status_.counters.silences;
  // A restart may have gone unnoticed, so the sensor may follow to another rate now.
  setup_.retry_rate();
  search("no scan for " + std::to_string(supervisor_.silence_ns(now_ns) / kNsPerMs) + " ms", false,
         now_ns);
}

void PlsDriver::enter(Phase phase, PlsState state, std::string reason) {
  phase_ = phase;
  status_.state = state;
  status_.reason = std::move(reason);
}

void PlsDriver::enter_search(Phase phase, int failures, const std::string& reason) {
  const bool failed = failures >= settings_.searches_until_failed;
  enter(phase, failed ? PlsState::kFailed : PlsState::kDetecting, std::string(reason));
}

void PlsDriver::enter_setup() {
  enter(Phase::kSetUp, PlsState::kConfiguring, setup_.reason());
}

}  // namespace topogeo::devices
