#include "topogeo/simulation/turning_emulator.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::simulation {
namespace {

constexpr double kBeamRadPerDeg = std::numbers::pi / 180.0;

}  // namespace

TurningEmulator::TurningEmulator(const devices::LineSettings& line, const Motor& motor,
                                 double range_max_m, std::uint64_t seed, Ranges ranges)
    : line_(line), range_max_m_(range_max_m), ranges_(std::move(ranges)), faults_(seed) {
  if (!(motor.turns_hz > 0.0 && motor.turns_hz <= 30.0) || !(motor.samples_hz > 0.0) ||
      line.baud == 0 || !ranges_) {
    throw std::invalid_argument(
        "an emulated laser that turns needs a speed of up to 30 turns a second, samples, a rate of "
        "the line above 0, and ranges to measure");
  }
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
  // The last beam is the rightmost: angles of the laser frame are counter-clockwise.
  const double last_deg = first_deg + static_cast<double>(count - 1) * step_deg;
  const BeamPattern beams{geometry::wrap_angle(-last_deg * kBeamRadPerDeg),
                          step_deg * kBeamRadPerDeg, count, range_max_m_};
  const std::vector<float> ranges_m = ranges_(beams, next_ns_);
  std::vector<double> readings_mm;
  readings_mm.reserve(count);
  for (std::size_t i = count; i-- > 0;) {
    const auto range_m = static_cast<double>(ranges_m[i]);
    const bool returned = std::isfinite(range_m) && range_m > 0.0 && range_m < range_max_m_;
    readings_mm.push_back(returned ? std::round(1000.0 * range_m) : 0.0);
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
