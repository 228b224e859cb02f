#include "topogeo/simulation/text_base_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kTextBaseMs_ns = 1'000'000;
/// A battery line follows so many reports.
constexpr std::uint64_t kReportsPerBattery = 50;

}  // namespace

TextBaseEmulator::TextBaseEmulator(const TextBaseEmulatorSettings& settings, std::int64_t now_ns)
    : settings_(settings), random_(settings.seed) {
  switch_on(now_ns);
}

void TextBaseEmulator::switch_on(std::int64_t now_ns) {
  switch_off(now_ns);
  on_ = true;
  began_ns_ = now_ns;
  ready_ns_ = next_ns_ = now_ns + settings_.start_up_ns;
}

void TextBaseEmulator::switch_off(std::int64_t /*now_ns*/) {
  output_.clear();
  reader_.clear();
  on_ = greeted_ = watchdog_ = false;
  wanted_mps_ = wheels_mps_ = wheels_m_ = {};
  reports_ = 0;
}

void TextBaseEmulator::set_fault(BaseFault fault, bool on) {
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

void TextBaseEmulator::stand_still(std::int64_t duration_ns) {
  hold_until_ns_ += duration_ns;
  next_ns_ += duration_ns;
}

void TextBaseEmulator::receive(std::span<const std::uint8_t> bytes,
                               const devices::LineSettings& host, std::int64_t now_ns) {
  tick(now_ns);
  if (!on_ || now_ns < ready_ns_ || host != settings_.line) return;
  for (const std::string& body : reader_.read(bytes)) obey(body, now_ns);
}

void TextBaseEmulator::obey(std::string_view body, std::int64_t now_ns) {
  if (body == "?")
    return say(to_line(devices::TextBaseHello{settings_.version, "emulator"}), now_ns);
  if (body == "S") return stop();
  const auto numbers = devices::text_base_numbers(body);
  if (!numbers || numbers->size() != 3 || (body[0] != 'V' && body[0] != 'W')) return;
  const double first = 1e-3 * static_cast<double>((*numbers)[0]);
  const double second = 1e-3 * static_cast<double>((*numbers)[1]);
  const double side = body[0] == 'W' ? 0.5 * settings_.track_m * second : 0.0;
  wanted_mps_ = body[0] == 'W' ? std::array{first - side, first + side} : std::array{first, second};
  hold_until_ns_ = now_ns + (*numbers)[2] * kTextBaseMs_ns;
  watchdog_ = false;
}

void TextBaseEmulator::say(std::string line, std::int64_t now_ns) {
  if (silent_) return;
  if (corrupts_) {
    line[random_.below(line.size())] ^= static_cast<char>(1U << random_.below(7));
  }
  if (truncates_) line.resize(random_.below(line.size()));
  if (!line.empty()) output_.send({line.begin(), line.end()}, settings_.line, now_ns);
}

void TextBaseEmulator::tick(std::int64_t now_ns) {
  if (!on_ || now_ns < ready_ns_) return;
  if (!std::exchange(greeted_, true)) {
    say(to_line(devices::TextBaseHello{settings_.version, "emulator"}), now_ns);
  }
  if (now_ns >= hold_until_ns_ && wanted_mps_ != std::array<double, 2>{}) {
    watchdog_ = true;
    stop();
  }
  while (now_ns >= next_ns_) {
    devices::TextBaseReport report;
    report.time_ms = static_cast<std::uint32_t>((next_ns_ - began_ns_) / kTextBaseMs_ns);
    for (std::size_t i = 0; i < 2; ++i) {
      report.ticks[i] =
          static_cast<std::int32_t>(std::lround(wheels_m_[i] * settings_.ticks_per_m));
    }
    report.emergency_stop = emergency_stop_;
    report.watchdog = watchdog_;
    report.bumper = bumper_;
    if (settings_.gyro)
      report.turn_mradps = static_cast<std::int32_t>(std::lround(1e3 * turn_radps_));
    say(to_line(report), next_ns_);
    if (reports_++ % kReportsPerBattery == 0) {
      say(to_line(devices::TextBaseBattery{
              static_cast<std::uint32_t>(std::lround(1e3 * settings_.battery_v))}),
          next_ns_);
    }
    next_ns_ += settings_.report_ns;
  }
}

void TextBaseEmulator::send_garbage(std::size_t bytes, std::int64_t now_ns) {
  std::vector<std::uint8_t> noise(bytes);
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random_.below(256));
  output_.send(std::move(noise), settings_.line, now_ns);
}

std::int64_t TextBaseEmulator::due_ns() const {
  if (!on_) return std::numeric_limits<std::int64_t>::max();
  const bool holds = wanted_mps_ != std::array<double, 2>{};
  return holds ? std::min(next_ns_, hold_until_ns_) : next_ns_;
}

std::vector<std::uint8_t> TextBaseEmulator::take_output(const devices::LineSettings& host,
                                                        std::int64_t now_ns) {
  return output_.take(host, now_ns);
}

geometry::Velocity TextBaseEmulator::commanded_velocity() const {
  if (!on_ || emergency_stop_) return {};
  return {0.5 * (wheels_mps_[0] + wheels_mps_[1]),
          (wheels_mps_[1] - wheels_mps_[0]) / settings_.track_m};
}

void TextBaseEmulator::moved(double forward_m, double turn_rad, double time_s) {
  const double side_m = 0.5 * settings_.track_m * turn_rad;
  wheels_m_[0] += forward_m - side_m;
  wheels_m_[1] += forward_m + side_m;
  if (time_s > 0.0) turn_radps_ = turn_rad / time_s;
  const double most_mps = settings_.acceleration_mps2 * time_s;
  for (std::size_t i = 0; i < 2; ++i) {
    const double wanted = emergency_stop_ || !on_ ? 0.0 : wanted_mps_[i];
    wheels_mps_[i] += std::clamp(wanted - wheels_mps_[i], -most_mps, most_mps);
  }
}

void TextBaseEmulator::press_bumpers(std::uint16_t pressed, std::int64_t /*now_ns*/) {
  bumper_ = pressed != 0;
}

}  // namespace topogeo::simulation
