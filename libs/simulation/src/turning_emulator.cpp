#include "topogeo/simulation/turning_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kBeamRadPerDeg = std::numbers::pi / 180.0;
/// Period of the error of the motor's control.
constexpr double kWobble_s = 5.0;
/// Change of the motor's speed, turns a second each second.
constexpr double kAcceleration = 5.0;

}  // namespace

TurningEmulator::TurningEmulator(const devices::LineSettings& line, const Motor& motor,
                                 double range_max_m, std::uint64_t seed, Ranges ranges)
    : line_(line),
      motor_(motor),
      mean_hz_(motor.turns_hz),
      range_max_m_(range_max_m),
      ranges_(std::move(ranges)),
      faults_(seed) {
  if (!(motor.turns_hz > 0.0 && motor.turns_hz <= 100.0) || !(motor.samples_hz > 0.0) ||
      !(motor.wobble >= 0.0 && motor.wobble < 1.0) || line.baud == 0 || !ranges_) {
    throw std::invalid_argument(
        "an emulated laser that turns needs a speed of up to 100 turns a second, a wobble of at "
        "least 0 and below 1, samples, a rate of the line above 0, and ranges to measure");
  }
}

double TurningEmulator::turn_motor(std::size_t samples) {
  const double phase_rad =
      geometry::wrap_angle(2.0 * std::numbers::pi / kWobble_s *
                           std::fmod(1e-9 * static_cast<double>(next_ns_), kWobble_s));
  const double change_hz = kAcceleration * static_cast<double>(samples) / motor_.samples_hz;
  mean_hz_ += std::clamp(motor_.turns_hz - mean_hz_, -change_hz, change_hz);
  return mean_hz_ * (1.0 + motor_.wobble * geometry::sincos(phase_rad).sin);
}

void TurningEmulator::tick(std::int64_t now_ns) {
  while (now_ns >= next_ns_) send_packet();
}

std::vector<std::uint8_t> TurningEmulator::take_output(const devices::LineSettings& host,
                                                       std::int64_t now_ns) {
  return output_.take(host, now_ns);
}

void TurningEmulator::switch_off() {
  next_ns_ = kNever_ns;
  output_.clear();
}

void TurningEmulator::fall_silent(std::int64_t now_ns) {
  tick(now_ns);
  output_.clear();
  silent_ = true;
}

void TurningEmulator::speak_again(std::int64_t now_ns) {
  tick(now_ns);
  silent_ = false;
}

std::vector<double> TurningEmulator::measure_mm(double first_deg, double step_deg,
                                                std::size_t count) const {
  // Angles of the laser frame are counter-clockwise: of a clockwise turn the last beam is the
  // rightmost.
  const double last_deg = first_deg + static_cast<double>(count - 1) * step_deg;
  const double right_deg = motor_.clockwise ? -last_deg : first_deg;
  const BeamPattern beams{geometry::wrap_angle(right_deg * kBeamRadPerDeg),
                          step_deg * kBeamRadPerDeg, count, range_max_m_};
  const std::vector<float> ranges_m = ranges_(beams, next_ns_);
  std::vector<double> readings_mm;
  readings_mm.reserve(count);
  for (const float range_m : ranges_m) {
    const bool returned =
        std::isfinite(range_m) && range_m > 0.0F && static_cast<double>(range_m) < range_max_m_;
    readings_mm.push_back(returned ? std::round(1000.0 * static_cast<double>(range_m)) : 0.0);
  }
  if (motor_.clockwise) std::ranges::reverse(readings_mm);
  return readings_mm;
}

/// The direction of a beam depends on its reading, so it is found by steps, from the reading of the
/// beam before.
std::vector<double> TurningEmulator::measure_aside_mm(double first_deg, double step_deg,
                                                      std::size_t count,
                                                      const BesideAxis& geometry) const {
  constexpr int kSteps = 3;
  const double far_mm = 1000.0 * range_max_m_;
  std::vector<double> readings_mm;
  double reading_mm = far_mm;
  for (std::size_t i = 0; i < count; ++i) {
    const double stated_deg = first_deg + static_cast<double>(i) * step_deg;
    for (int step = 0; step < kSteps; ++step) {
      const double guess_mm = reading_mm;
      const double aside_deg = geometry.aside_deg(guess_mm > 0.0 ? guess_mm : far_mm);
      const double range_mm = measure_mm(stated_deg + aside_deg, step_deg, 1).front();
      reading_mm = range_mm > 0.0 ? std::round(geometry.reading_mm(range_mm)) : 0.0;
      if (reading_mm == guess_mm) break;
    }
    readings_mm.push_back(reading_mm);
  }
  return readings_mm;
}

void TurningEmulator::send(std::vector<std::uint8_t> packet) {
  if (!silent_) output_.send(faults_.apply(std::move(packet)), line_, next_ns_);
}

void TurningEmulator::answer(std::vector<std::uint8_t> bytes, std::int64_t at_ns) {
  output_.send(std::move(bytes), line_, at_ns);
}

}  // namespace topogeo::simulation
