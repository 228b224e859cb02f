#include "topogeo/simulation/two_wheel_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace topogeo::simulation {

void TwoWheelEmulator::switch_on(std::int64_t now_ns) {
  switch_off(now_ns);
  on_ = true;
  began_ns_ = now_ns;
  ready_ns_ = next_ns_ = now_ns + settings_.start_up_ns;
}

void TwoWheelEmulator::switch_off(std::int64_t /*now_ns*/) {
  output_.clear();
  on_ = false;
  wanted_mps_ = wheels_mps_ = wheels_m_ = {};
  heading_rad_ = turn_radps_ = 0.0;
  reports_ = 0;
  forget();
}

void TwoWheelEmulator::set_fault(BaseFault fault, bool on) {
  switch (fault) {
    case BaseFault::kCorrupted:
      corrupts_ = on;
      return;
    case BaseFault::kTruncated:
      truncates_ = on;
      return;
    case BaseFault::kSilent:
      silent_ = on;
      return;
    case BaseFault::kEcho:
      return;
  }
}

void TwoWheelEmulator::receive(std::span<const std::uint8_t> bytes,
                               const devices::LineSettings& host, std::int64_t now_ns) {
  tick(now_ns);
  if (has_started(now_ns) && host == settings_.line) obey(bytes, now_ns);
}

void TwoWheelEmulator::say_report(std::vector<std::uint8_t> message, std::int64_t now_ns) {
  ++reports_;
  say(std::move(message), now_ns);
}

void TwoWheelEmulator::say(std::vector<std::uint8_t> message, std::int64_t now_ns) {
  if (silent_) return;
  if (corrupts_) {
    message[random_.below(message.size())] ^=
        static_cast<std::uint8_t>(1U << random_.below(settings_.corrupted_bits));
  }
  if (truncates_) message.resize(random_.below(message.size()));
  if (!message.empty()) output_.send(std::move(message), settings_.line, now_ns);
}

void TwoWheelEmulator::tick(std::int64_t now_ns) {
  if (!on_) return;
  for (; now_ns >= next_ns_; next_ns_ += settings_.report_ns) report(next_ns_);
}

void TwoWheelEmulator::send_garbage(std::size_t bytes, std::int64_t now_ns) {
  std::vector<std::uint8_t> noise(bytes);
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random_.below(256));
  output_.send(std::move(noise), settings_.line, now_ns);
}

std::int64_t TwoWheelEmulator::due_ns() const {
  return on_ ? next_ns_ : std::numeric_limits<std::int64_t>::max();
}

std::vector<std::uint8_t> TwoWheelEmulator::take_output(const devices::LineSettings& host,
                                                        std::int64_t now_ns) {
  return output_.take(host, now_ns);
}

std::int64_t TwoWheelEmulator::ticks(std::size_t wheel) const {
  return std::llround(wheels_m_[wheel] * settings_.ticks_per_m);
}

geometry::Velocity TwoWheelEmulator::commanded_velocity() const {
  if (!on_ || !motors_on()) return {};
  return {0.5 * (wheels_mps_[0] + wheels_mps_[1]),
          (wheels_mps_[1] - wheels_mps_[0]) / settings_.track_m};
}

void TwoWheelEmulator::moved(double forward_m, double turn_rad, double time_s) {
  const double side_m = 0.5 * settings_.track_m * turn_rad;
  wheels_m_[0] += forward_m - side_m;
  wheels_m_[1] += forward_m + side_m;
  heading_rad_ += turn_rad;
  if (time_s > 0.0) turn_radps_ = turn_rad / time_s;
  const double most_mps = settings_.acceleration_mps2 * time_s;
  for (std::size_t i = 0; i < 2; ++i) {
    const double wanted_mps = motors_on() ? wanted_mps_[i] : 0.0;
    wheels_mps_[i] += std::clamp(wanted_mps - wheels_mps_[i], -most_mps, most_mps);
  }
}

}  // namespace topogeo::simulation
