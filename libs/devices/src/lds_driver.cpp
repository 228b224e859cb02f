#include "topogeo/devices/lds_driver.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr double kSecondsPerMinute = 60.0;
constexpr double kDegreesPerTurn = 360.0;
constexpr std::uint8_t kStartLetter = 'b';
constexpr std::uint8_t kStopLetter = 'e';
/// No motor changes its speed by more from one packet to the next.
constexpr double kSameLdsSpeed = 0.25;
constexpr double kLargestGap = 0.25;

const LdsFormat& format_of(const LaserModel& model) {
  return model.family == "xv11" ? kXv11 : kLds01;
}

LdsChecksum checksum_of(const LaserModel& model, const LdsSettings& settings) {
  if (settings.checksum != LdsChecksum::kModel) return settings.checksum;
  return model.family == "xv11" ? LdsChecksum::kDrop : LdsChecksum::kLearn;
}

}  // namespace

LdsDriver::LdsDriver(const LaserModel& model, const TurningLaserSettings& turning,
                     const LdsSettings& settings)
    : TurningLaserDriver(model, turning, format_of(model).clockwise),
      format_(format_of(model)),
      decoder_(format_, checksum_of(model, settings)),
      clock_(line_time_ns(format_.packet_bytes(), line())) {}

void LdsDriver::restart() {
  decoder_.clear();
  interrupt();
}

void LdsDriver::interrupt() {
  last_.reset();
  clock_.restart();
}

std::vector<TurningLaserDriver::StartStep> LdsDriver::start_steps() const {
  if (model().family == "xv11") return {};
  return {{0, {std::nullopt, {kStartLetter}, {}}}};
}

std::vector<LineOrder> LdsDriver::end_orders() const {
  if (model().family == "xv11") return {};
  return {{std::nullopt, {kStopLetter}, {}}};
}

void LdsDriver::decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  while (const std::optional<LdsDecoder::Found> found = decoder_.next()) {
    take(found->packet, now_ns - line_time_ns(found->bytes_since, line()), now_ns);
  }
}

void LdsDriver::take(const LdsPacket& packet, std::int64_t arrival_ns, std::int64_t now_ns) {
  if (last_ && *last_ == packet) {
    ++repeated_;
    return;
  }
  std::size_t ahead = format_.packets;
  bool steady = true;
  if (last_) {
    ahead = 1 + (packet.number + format_.packets - last_->number - 1) % format_.packets;
    const double change = std::fabs(static_cast<double>(packet.speed) - last_->speed);
    steady = change <= kSameLdsSpeed * last_->speed;
  }
  last_ = packet;
  if (!steady) {
    ++unsteady_;
    clock_.restart();
    restart_turn();
    return;
  }
  heard(arrival_ns);
  const double turns = static_cast<double>(ahead) / static_cast<double>(format_.packets);
  const double turn_ns = 1e9 / turns_hz();
  const std::optional<std::int64_t> time_ns =
      clock_.at(std::llround(turns * turn_ns), std::llround(turn_ns), arrival_ns, now_ns);
  if (!time_ns) {
    ++untimed_;
    return restart_turn();
  }
  // The assembler takes almost a whole turn for a small step back.
  if (turns > kLargestGap) restart_turn();
  add_beams(packet, *time_ns);
}

void LdsDriver::add_beams(const LdsPacket& packet, std::int64_t last_beam_ns) {
  const double step_ns = 1e9 / (turns_hz() * kDegreesPerTurn);
  for (std::size_t i = 0; i < format_.readings; ++i) {
    const auto degree = static_cast<double>(packet.number * format_.readings + i);
    const auto until_last = static_cast<double>(format_.readings - 1 - i);
    add_beam({degree * std::numbers::pi / 180.0, 1e-3 * packet.readings[i].distance_mm,
              last_beam_ns - std::llround(until_last * step_ns)});
  }
}

double LdsDriver::turns_hz() const {
  return last_ ? last_->speed * format_.rpm_per_unit / kSecondsPerMinute : 0.0;
}

TurningLaserDriver::Drops LdsDriver::drops() const {
  const LdsCounters& counters = decoder_.counters();
  return {{"bad checksum", counters.bad_checksum},
          {"noise bytes", counters.noise_bytes},
          {"implausible packet", counters.implausible + counters.alone + unsteady_},
          {"repeated packet", repeated_},
          {"packet without time", untimed_}};
}

void LdsDriver::complete(LaserHealth& health) const {
  if (health.state == LaserState::kRunning && decoder_.checksum() == LdsChecksum::kWarn) {
    health.reason = "checksums are not checked";
  }
}

}  // namespace topogeo::devices
