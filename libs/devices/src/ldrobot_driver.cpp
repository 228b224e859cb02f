#include "topogeo/devices/ldrobot_driver.hpp"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "topogeo/devices/ldrobot_optics.hpp"
#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr double kRadPerCdeg = std::numbers::pi / 18'000.0;
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
/// Far returns, whose directions differ least, keep their place in the turn.
constexpr double kFar_mm = 8000.0;

/// Replaces what an LD08 states by what the centre of the laser sees.
void look_from_axis(TurningBeam& beam) {
  constexpr double kRadPerDeg = 100.0 * kRadPerCdeg;
  const double far_deg = ld08_point(kFar_mm).back_deg;
  beam.turned_rad -= far_deg * kRadPerDeg;
  if (beam.range_m <= 0.0) return;
  const Ld08Point point = ld08_point(1e3 * beam.range_m);
  beam.range_m = 1e-3 * point.range_mm;
  beam.aside_rad = (far_deg - point.back_deg) * kRadPerDeg;
}

bool near_to(double value, double expected, double share, double margin) {
  return std::fabs(value - expected) <= share * expected + margin;
}

}  // namespace

LdRobotDriver::LdRobotDriver(const LaserModel& model, const TurningLaserSettings& settings)
    : TurningLaserDriver(model, settings, true),
      beside_axis_(model.family == "ldrobot_offset"),
      clock_(line_time_ns(kLdPacket_bytes, line())) {}

void LdRobotDriver::restart() {
  decoder_.clear();
  last_.reset();
}

void LdRobotDriver::interrupt() {
  last_.reset();
}

void LdRobotDriver::decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  while (const std::optional<LdDecoder::Found> found = decoder_.next()) {
    take(found->packet, now_ns - line_time_ns(found->bytes_since, line()));
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
    restart_turn();
    return;
  }
  last_arrival_ns_ = arrival_ns;
  heard(arrival_ns);
  add_beams(packet, clock_.map(device_ns_, arrival_ns));
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
    const bool returned = point.distance_mm > 0 && point.intensity >= settings().least_intensity;
    TurningBeam beam;
    beam.turned_rad = (packet.start_cdeg + place * step_cdeg) * kRadPerCdeg;
    beam.range_m = returned ? 1e-3 * point.distance_mm : 0.0;
    beam.time_ns = last_beam_ns - std::llround((kGaps - place) * step_ns);
    if (beside_axis_) look_from_axis(beam);
    add_beam(beam);
  }
}

double LdRobotDriver::turns_hz() const {
  return last_ ? last_->speed_deg_s / 360.0 : 0.0;
}

TurningLaserDriver::Drops LdRobotDriver::drops() const {
  return {{"bad checksum", decoder_.counters().bad_checksum},
          {"noise bytes", decoder_.counters().noise_bytes},
          {"implausible packet", decoder_.counters().implausible + implausible_},
          {"repeated packet", repeated_}};
}

}  // namespace topogeo::devices
