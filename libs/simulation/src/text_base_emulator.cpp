#include "topogeo/simulation/text_base_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kTextBaseMs_ns = 1'000'000;
/// A battery line follows so many reports.
constexpr std::uint64_t kReportsPerBattery = 50;

TwoWheelEmulatorSettings text_wheels(const TextBaseEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = settings.ticks_per_m,
          .track_m = settings.track_m,
          .acceleration_mps2 = settings.acceleration_mps2,
          .report_ns = settings.report_ns,
          .start_up_ns = settings.start_up_ns,
          .seed = settings.seed,
          .corrupted_bits = 7};
}

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  const std::string line = to_line(message);
  return {line.begin(), line.end()};
}

}  // namespace

TextBaseEmulator::TextBaseEmulator(const TextBaseEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(text_wheels(settings)), text_(settings) {
  switch_on(now_ns);
}

void TextBaseEmulator::forget() {
  reader_.clear();
  greeted_ = watchdog_ = false;
}

void TextBaseEmulator::stand_still(std::int64_t duration_ns) {
  hold_until_ns_ += duration_ns;
  TwoWheelEmulator::stand_still(duration_ns);
}

void TextBaseEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  for (const std::string& body : reader_.read(bytes)) obey_line(body, now_ns);
}

void TextBaseEmulator::obey_line(std::string_view body, std::int64_t now_ns) {
  if (body == "?") return greet(now_ns);
  if (body == "S") return want({});
  const auto numbers = devices::text_base_numbers(body);
  if (!numbers || numbers->size() != 3 || (body[0] != 'V' && body[0] != 'W')) return;
  const double first = 1e-3 * static_cast<double>((*numbers)[0]);
  const double second = 1e-3 * static_cast<double>((*numbers)[1]);
  const double side = body[0] == 'W' ? 0.5 * text_.track_m * second : 0.0;
  want(body[0] == 'W' ? std::array{first - side, first + side} : std::array{first, second});
  hold_until_ns_ = now_ns + (*numbers)[2] * kTextBaseMs_ns;
  watchdog_ = false;
}

void TextBaseEmulator::greet(std::int64_t now_ns) {
  say(bytes_of(devices::TextBaseHello{text_.version, "emulator"}), now_ns);
}

void TextBaseEmulator::tick(std::int64_t now_ns) {
  if (!has_started(now_ns)) return;
  if (!std::exchange(greeted_, true)) greet(now_ns);
  if (now_ns >= hold_until_ns_ && holds()) {
    watchdog_ = true;
    want({});
  }
  TwoWheelEmulator::tick(now_ns);
}

void TextBaseEmulator::report(std::int64_t now_ns) {
  devices::TextBaseReport report;
  report.time_ms = static_cast<std::uint32_t>((now_ns - began_ns()) / kTextBaseMs_ns);
  for (std::size_t i = 0; i < 2; ++i) report.ticks[i] = static_cast<std::int32_t>(ticks(i));
  report.emergency_stop = emergency_stop_;
  report.watchdog = watchdog_;
  report.bumper = bumper_;
  if (text_.gyro) report.turn_mradps = static_cast<std::int32_t>(std::lround(1e3 * turn_radps()));
  const bool with_battery = reports() % kReportsPerBattery == 0;
  say_report(bytes_of(report), now_ns);
  if (!with_battery) return;
  const long millivolts = std::lround(1e3 * text_.battery_v);
  say(bytes_of(
          devices::TextBaseBattery{static_cast<std::uint32_t>(millivolts), text_.battery_percent}),
      now_ns);
}

std::int64_t TextBaseEmulator::due_ns() const {
  const std::int64_t due_ns = TwoWheelEmulator::due_ns();
  return holds() ? std::min(due_ns, hold_until_ns_) : due_ns;
}

void TextBaseEmulator::press_bumpers(std::uint16_t pressed, std::int64_t /*now_ns*/) {
  bumper_ = pressed != 0;
}

}  // namespace topogeo::simulation
