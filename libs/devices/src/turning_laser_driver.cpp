#include "topogeo/devices/turning_laser_driver.hpp"

#include <algorithm>
#include <limits>

namespace topogeo::devices {
namespace {

/// After this many times the allowed silence the laser counts as failed, and is started again.
constexpr std::int64_t kFailedAfter = 5;
constexpr std::int64_t kNothingDue_ns = std::numeric_limits<std::int64_t>::max();

}  // namespace

TurningLaserDriver::TurningLaserDriver(const LaserModel& model,
                                       const TurningLaserSettings& settings, bool clockwise)
    : model_(model),
      settings_(checked(settings)),
      line_(line_of(model, settings)),
      turns_(settings_, model.beams, model.range_max_m, clockwise),
      reason_("the port is closed") {}

std::int64_t TurningLaserDriver::failed_after_ns() const {
  return kFailedAfter * settings_.silence_ns;
}

void TurningLaserDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}}};
  turns_.restart();
  restart();
  waits_since_ns_ = now_ns;
  start(now_ns);
  wait(LaserState::kStarting, "listens for a " + std::string(model_.title));
}

void TurningLaserDriver::start(std::int64_t now_ns) {
  started_ns_ = now_ns;
  steps_.clear();
  for (StartStep& step : start_steps()) {
    step.after_ns += now_ns;
    steps_.push_back(std::move(step));
  }
}

void TurningLaserDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  steps_.clear();
  wait(LaserState::kOffline, "the port is closed");
}

void TurningLaserDriver::end(std::int64_t /*now_ns*/) {
  if (state_ == LaserState::kOffline) return;
  steps_.clear();
  for (LineOrder& order : end_orders()) orders_.push_back(std::move(order));
  wait(LaserState::kOffline, "the program ends");
}

void TurningLaserDriver::wait(LaserState state, std::string reason) {
  state_ = state;
  reason_ = std::move(reason);
}

void TurningLaserDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || bytes.empty()) return;
  last_byte_ns_ = now_ns;
  decode(bytes, now_ns);
}

void TurningLaserDriver::add_beam(TurningBeam beam) {
  beam.time_ns -= settings_.packet_delay_ns;
  turns_.add(beam);
  if (std::optional<LaserScan> scan = turns_.take_scan()) {
    wait(LaserState::kRunning, {});
    scans_.push_back(*std::move(scan));
  }
}

void TurningLaserDriver::tick(std::int64_t now_ns) {
  if (state_ == LaserState::kOffline) return;
  while (!steps_.empty() && steps_.front().after_ns <= now_ns) {
    orders_.push_back(std::move(steps_.front().order));
    steps_.pop_front();
  }
  if (now_ns < waits_since_ns_ + settings_.silence_ns) return;
  if (state_ == LaserState::kRunning) {
    ++silences_;
    turns_.restart();
    interrupt();
    start(now_ns);
    wait(LaserState::kStarting,
         "no packet for " + std::to_string((now_ns - waits_since_ns_) / 1'000'000) + " ms");
  }
  if (now_ns < waits_since_ns_ + failed_after_ns()) return;
  if (now_ns >= started_ns_ + failed_after_ns()) start(now_ns);
  const bool other =
      last_byte_ns_ > waits_since_ns_ && now_ns - last_byte_ns_ < settings_.silence_ns;
  wait(LaserState::kFailed,
       other ? "bytes arrive, but no packets of a " + std::string(model_.title) + " at " +
                   std::to_string(line_.baud) + " baud: expected that laser (laser.model)"
             : "no bytes arrive: is the laser connected and does it turn?");
}

std::int64_t TurningLaserDriver::due_ns() const {
  const std::int64_t step_ns = steps_.empty() ? kNothingDue_ns : steps_.front().after_ns;
  switch (state_) {
    case LaserState::kRunning:
      return std::min(step_ns, waits_since_ns_ + settings_.silence_ns);
    case LaserState::kStarting:
      return std::min(step_ns, waits_since_ns_ + failed_after_ns());
    case LaserState::kFailed:
      return std::min(step_ns, started_ns_ + failed_after_ns());
    case LaserState::kOffline:
      break;
  }
  return kNothingDue_ns;
}

std::vector<LineOrder> TurningLaserDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> TurningLaserDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth TurningLaserDriver::health() const {
  LaserHealth health;
  health.state = state_;
  health.reason = reason_;
  health.line = line_;
  health.searches = silences_;
  if (state_ == LaserState::kRunning) health.turns_hz = turns_hz();
  health.drops = drops();
  health.drops.emplace_back("incomplete turn", turns_.incomplete());
  complete(health);
  return health;
}

}  // namespace topogeo::devices
