#include "topogeo/devices/ydlidar_driver.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/rplidar_protocol.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kYdMs_ns = 1'000'000;
/// Time from one request to the next; the answers take a few milliseconds.
constexpr std::int64_t kYdStep_ns = 100 * kYdMs_ns;
/// The longest packet, for the clock: 40 samples.
constexpr std::size_t kYdPacket_bytes = 90;
/// Turns a second that a laser of this kind makes.
constexpr double kSlowestYd_hz = 2.0;
constexpr double kFastestYd_hz = 20.0;
/// A packet follows the last one if their angles differ by its samples, give or take this.
constexpr double kSameCount = 2.0;
/// The rate of a laser that is told another one is forgotten after some multiple of this.
constexpr double kForgotten_ns = 2e10;
/// The arrival of one packet may be late.
constexpr int kLeastTurns = 5;
constexpr double kRadPerDegree = std::numbers::pi / 180.0;

bool needs_dtr(const LaserModel& model, RpMotor motor) {
  if (motor == RpMotor::kDtr || motor == RpMotor::kNone) return motor == RpMotor::kDtr;
  return model.name == "ydlidar_x2" || model.name == "ydlidar_x4";
}

}  // namespace

YdLidarDriver::YdLidarDriver(const LaserModel& model, const TurningLaserSettings& turning,
                             RpMotor motor)
    : TurningLaserDriver(model, turning, true),
      asked_(model.family != "ydlidar_one_way"),
      triangulates_(model.family != "ydlidar_tof"),
      dtr_(needs_dtr(model, motor)),
      clock_(line_time_ns(kYdPacket_bytes, line())),
      turns_hz_(model.turns_hz) {}

void YdLidarDriver::restart() {
  decoder_.clear();
  device_.clear();
  status_ = 0;
  interrupt();
}

void YdLidarDriver::interrupt() {
  last_.reset();
  turn_samples_.reset();
  step_q6_ = sample_ns_ = counted_ns_ = counted_ = 0.0;
  turns_ = 0;
  clock_.restart();
}

std::vector<TurningLaserDriver::StartStep> YdLidarDriver::start_steps() const {
  std::vector<StartStep> steps;
  if (dtr_) steps.push_back({0, {std::nullopt, {}, true}});
  if (!asked_) return steps;
  std::int64_t after_ns = 0;
  for (const std::uint8_t command :
       {yd_command::kStop, yd_command::kGetInfo, yd_command::kGetHealth, yd_command::kScan}) {
    steps.push_back({after_ns, {std::nullopt, yd_request(command), {}}});
    after_ns += kYdStep_ns;
  }
  return steps;
}

std::vector<LineOrder> YdLidarDriver::end_orders() const {
  std::vector<LineOrder> orders;
  if (asked_) orders.push_back({std::nullopt, yd_request(yd_command::kStop), {}});
  if (dtr_) orders.push_back({std::nullopt, {}, false});
  return orders;
}

void YdLidarDriver::decode(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  while (const std::optional<YdDecoder::Found> found = decoder_.next()) {
    if (found->packet) {
      take(*found->packet, now_ns - line_time_ns(found->bytes_since, line()), now_ns);
    } else {
      take_answer(*found);
    }
  }
}

void YdLidarDriver::take_answer(const YdDecoder::Found& found) {
  if (found.answer_type == yd_answer::kInfo) {
    device_ = "YDLIDAR, " + text_of(rp_info(found.answer));
  } else if (found.answer_type == yd_answer::kHealth) {
    status_ = found.answer[0];
  }
}

void YdLidarDriver::take(const YdPacket& packet, std::int64_t arrival_ns, std::int64_t now_ns) {
  if (last_ && *last_ == packet) {
    ++repeated_;
    return;
  }
  if (packet.samples.size() > 1) {
    step_q6_ = packet.span_q6() / static_cast<double>(packet.samples.size() - 1);
  }
  unsigned ahead_q6 = kYdTurnQ6;
  if (last_ && last_->last_q6 != packet.last_q6) {
    ahead_q6 = (kYdTurnQ6 + packet.last_q6 - last_->last_q6) % kYdTurnQ6;
  }
  last_ = packet;
  heard(arrival_ns);
  const auto sent = static_cast<double>(packet.samples.size());
  const double by_angle = step_q6_ > 0.0 ? ahead_q6 / step_q6_ : sent;
  const bool contiguous = std::fabs(by_angle - sent) <= kSameCount;
  if (!contiguous) turn_samples_.reset();
  count_samples(packet, arrival_ns);
  if (sample_ns_ <= 0.0) return skip(untimed_);
  const double turn_ns = sample_ns_ * kYdTurnQ6 / step_q6_;
  const double passed_ns = sample_ns_ * (contiguous ? sent : by_angle);
  const std::optional<std::int64_t> time_ns =
      clock_.at(std::llround(passed_ns), std::llround(turn_ns), arrival_ns, now_ns);
  if (!time_ns) {
    turn_samples_.reset();
    return skip(untimed_);
  }
  if (ahead_q6 > kYdTurnQ6 / 4) skip(gaps_);
  add_beams(packet, *time_ns);
}

void YdLidarDriver::skip(std::uint64_t& count) {
  ++count;
  restart_turn();
}

/// The time of a sample is constant: that of many turns without a gap, divided by their samples.
void YdLidarDriver::count_samples(const YdPacket& packet, std::int64_t arrival_ns) {
  if (turn_samples_) *turn_samples_ += packet.samples.size();
  if (!packet.starts_turn) return;
  const double reported_hz = 0.1 * packet.turns_dhz;
  if (turn_samples_ && *turn_samples_ > 0) {
    const auto turn_ns = static_cast<double>(arrival_ns - turn_began_ns_);
    counted_ns_ += turn_ns;
    counted_ += static_cast<double>(*turn_samples_);
    if (++turns_ >= kLeastTurns) sample_ns_ = counted_ns_ / counted_;
    if (turn_ns > 0.0) turns_hz_ = 1e9 / turn_ns;
    if (counted_ns_ > kForgotten_ns) {
      counted_ns_ *= 0.5;
      counted_ *= 0.5;
    }
  }
  if (reported_hz >= kSlowestYd_hz && reported_hz <= kFastestYd_hz) turns_hz_ = reported_hz;
  turn_samples_ = 0;
  turn_began_ns_ = arrival_ns;
}

void YdLidarDriver::add_beams(const YdPacket& packet, std::int64_t last_beam_ns) {
  const std::size_t count = packet.samples.size();
  const double gaps = count > 1 ? static_cast<double>(count - 1) : 1.0;
  const double step_deg = packet.span_q6() / 64.0 / gaps;
  const double far_deg = triangulates_ ? yd_far_correction_deg() : 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double distance_mm = (triangulates_ ? 0.25 : 1.0) * packet.samples[i];
    TurningBeam beam;
    beam.turned_rad =
        (packet.first_q6 / 64.0 + static_cast<double>(i) * step_deg + far_deg) * kRadPerDegree;
    beam.range_m = 1e-3 * distance_mm;
    beam.time_ns = last_beam_ns - std::llround(static_cast<double>(count - 1 - i) * sample_ns_);
    if (triangulates_ && distance_mm > 0.0) {
      beam.aside_rad = (yd_correction_deg(distance_mm) - far_deg) * kRadPerDegree;
    }
    add_beam(beam);
  }
}

TurningLaserDriver::Drops YdLidarDriver::drops() const {
  const YdCounters& counters = decoder_.counters();
  return {{"bad checksum", counters.bad_checksum},
          {"noise bytes", counters.noise_bytes},
          {"implausible packet", counters.implausible + counters.alone},
          {"repeated packet", repeated_},
          {"gap in the samples", gaps_},
          {"packet without time", untimed_}};
}

void YdLidarDriver::complete(LaserHealth& health) const {
  health.device = device_;
  health.error_level = status_ == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(status_ + 1);
}

}  // namespace topogeo::devices
