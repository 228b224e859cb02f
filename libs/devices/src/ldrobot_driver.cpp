#include "topogeo/devices/ldrobot_driver.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr double kRadPerCdeg = std::numbers::pi / 18'000.0;
/// After this many times the allowed silence the laser counts as failed.
constexpr std::int64_t kFailedAfter = 5;
/// The laser's time cannot be compared over a longer pause: at 13 turns a second half a turn takes
/// 38 ms.
constexpr std::uint32_t kLongestPause_ms = 30;
/// Two packets of one laser differ in speed and width by the control of its motor, and by rounding.
constexpr double kSameSpeed = 0.25;
constexpr double kSameAngleCdeg = 50.0;
/// A packet begins where the last one and the speed lead: the time stamps are whole milliseconds.
constexpr double kStampError_s = 0.002;
constexpr double kPlaceCdeg = 300.0;
/// Time of the host and of the laser since the last packet differ by less, unless the laser
/// restarted.
constexpr std::int64_t kRestarted_ns = 1'000'000'000;

TurningLaserSettings checked_turning(TurningLaserSettings settings) {
  settings.check();
  return settings;
}

LineSettings line_of(const LaserModel& model, const TurningLaserSettings& settings) {
  return {settings.baud > 0 ? settings.baud : model.line.baud, model.line.parity};
}

bool near_to(double value, double expected, double share, double margin) {
  return std::fabs(value - expected) <= share * expected + margin;
}

std::string listening(const LaserModel& model) {
  return "listens for a " + std::string(model.title);
}

}  // namespace

LdRobotDriver::LdRobotDriver(const LaserModel& model, const TurningLaserSettings& settings)
    : model_(model),
      settings_(checked_turning(settings)),
      line_(line_of(model, settings)),
      turns_(settings_, model.beams, model.range_max_m, true),
      clock_(line_time_ns(kLdPacket_bytes, line_)),
      reason_("the port is closed") {}

void LdRobotDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}}};
  decoder_.clear();
  turns_.restart();
  last_.reset();
  waits_since_ns_ = now_ns;
  wait(LaserState::kStarting, listening(model_));
}

void LdRobotDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  wait(LaserState::kOffline, "the port is closed");
}

void LdRobotDriver::wait(LaserState state, std::string reason) {
  state_ = state;
  reason_ = std::move(reason);
}

void LdRobotDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || bytes.empty()) return;
  last_byte_ns_ = now_ns;
  decoder_.push(bytes);
  while (const std::optional<LdDecoder::Found> found = decoder_.next()) {
    take(found->packet, now_ns - line_time_ns(found->bytes_since, line_));
  }
}

void LdRobotDriver::take(const LdPacket& packet, std::int64_t arrival_ns) {
  if (last_ && *last_ == packet) {
    ++repeated_;
    return;
  }
  const std::uint32_t passed_ms =
      last_ ? (kLdTimeWrap_ms + packet.time_ms - last_->time_ms) % kLdTimeWrap_ms : 0;
  const bool fits = follows(packet, passed_ms);
  const std::int64_t passed_ns = static_cast<std::int64_t>(passed_ms) * 1'000'000;
  device_ns_ += passed_ns;
  const std::int64_t apart_ns = arrival_ns - last_arrival_ns_ - passed_ns;
  if (!last_ || std::llabs(apart_ns) > kRestarted_ns) clock_.restart();
  last_ = packet;
  if (!fits) {
    turns_.restart();
    return;
  }
  last_arrival_ns_ = waits_since_ns_ = arrival_ns;
  add_beams(packet, clock_.map(device_ns_, arrival_ns) - settings_.packet_delay_ns);
}

bool LdRobotDriver::follows(const LdPacket& packet, std::uint32_t passed_ms) {
  if (!last_) return false;  // whether it was a packet at all, only the next one shows
  if (passed_ms > kLongestPause_ms) {
    ++implausible_;
    return false;
  }
  const double speed_cdeg_s = 100.0 * packet.speed_deg_s;
  const double expected_cdeg = speed_cdeg_s * 1e-3 * passed_ms;
  const double advance_cdeg = (kLdTurnCdeg + packet.start_cdeg - last_->start_cdeg) % kLdTurnCdeg;
  const bool fits =
      near_to(packet.speed_deg_s, last_->speed_deg_s, kSameSpeed, 0.0) &&
      near_to(packet.span_cdeg(), last_->span_cdeg(), kSameSpeed, kSameAngleCdeg) &&
      near_to(advance_cdeg, expected_cdeg, 0.0, kPlaceCdeg + kStampError_s * speed_cdeg_s) &&
      advance_cdeg > 0.0;
  if (!fits) ++implausible_;
  return fits;
}

void LdRobotDriver::add_beams(const LdPacket& packet, std::int64_t last_beam_ns) {
  constexpr double kGaps = static_cast<double>(kLdPoints - 1);
  const double step_cdeg = packet.span_cdeg() / kGaps;
  const double step_ns = 1e9 * step_cdeg / (100.0 * packet.speed_deg_s);
  for (std::size_t i = 0; i < kLdPoints; ++i) {
    const LdPoint& point = packet.points[i];
    const auto place = static_cast<double>(i);
    TurningBeam beam;
    beam.turned_rad = (packet.start_cdeg + place * step_cdeg) * kRadPerCdeg;
    beam.range_m = point.intensity < settings_.least_intensity ? 0.0 : 1e-3 * point.distance_mm;
    beam.time_ns = last_beam_ns - std::llround((kGaps - place) * step_ns);
    turns_.add(beam);
    if (std::optional<LaserScan> scan = turns_.take_scan()) {
      wait(LaserState::kRunning, {});
      scans_.push_back(*std::move(scan));
    }
  }
}

void LdRobotDriver::tick(std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || now_ns < waits_since_ns_ + settings_.silence_ns) return;
  if (state_ == LaserState::kRunning) {
    ++silences_;
    turns_.restart();
    last_.reset();
    wait(LaserState::kStarting,
         "no packet for " + std::to_string((now_ns - waits_since_ns_) / 1'000'000) + " ms");
  }
  if (now_ns < waits_since_ns_ + kFailedAfter * settings_.silence_ns) return;
  const bool other =
      last_byte_ns_ > waits_since_ns_ && now_ns - last_byte_ns_ < settings_.silence_ns;
  wait(LaserState::kFailed,
       other ? "bytes arrive, but no packets of a " + std::string(model_.title) + " at " +
                   std::to_string(line_.baud) + " baud: expected that laser (laser.model)"
             : "no bytes arrive: is the laser connected and does it turn?");
}

std::int64_t LdRobotDriver::due_ns() const {
  switch (state_) {
    case LaserState::kRunning:
      return waits_since_ns_ + settings_.silence_ns;
    case LaserState::kStarting:
      return waits_since_ns_ + kFailedAfter * settings_.silence_ns;
    case LaserState::kOffline:
    case LaserState::kFailed:
      break;
  }
  return std::numeric_limits<std::int64_t>::max();
}

std::vector<LineOrder> LdRobotDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> LdRobotDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth LdRobotDriver::health() const {
  LaserHealth health;
  health.state = state_;
  health.reason = reason_;
  health.line = line_;
  health.searches = silences_;
  if (state_ == LaserState::kRunning && last_) health.turns_hz = last_->speed_deg_s / 360.0;
  health.drops = {{"bad checksum", decoder_.counters().bad_checksum},
                  {"noise bytes", decoder_.counters().noise_bytes},
                  {"implausible packet", decoder_.counters().implausible + implausible_},
                  {"repeated packet", repeated_},
                  {"incomplete turn", turns_.incomplete()}};
  return health;
}

}  // namespace topogeo::devices
