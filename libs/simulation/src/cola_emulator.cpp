#include "topogeo/simulation/cola_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace topogeo::simulation {
namespace {

using devices::ColaWriter;

/// Beams that are measured at one instant.
constexpr std::size_t kColaChunk = 6;
constexpr double kColaTurn_deg = 360.0;
constexpr double kColaAhead_deg = 90.0;

}  // namespace

ColaEmulator::ColaEmulator(const ColaEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns)
    : TurningEmulator(
          settings.line,
          {settings.turns_hz, settings.turns_hz * kColaTurn_deg / settings.step_deg, 0.0, false},
          settings.range_max_m, settings.seed, std::move(ranges)),
      settings_(settings),
      ready_ns_(now_ns) {}

void ColaEmulator::switch_off() {
  TurningEmulator::switch_off();
  on_ = false;
  reader_.clear();
}

void ColaEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  on_ = true;
  ready_ns_ = now_ns + settings_.start_up_ns;
}

std::uint32_t ColaEmulator::clock_us(std::int64_t now_ns) const {
  constexpr std::int64_t kUs_ns = 1000;
  return settings_.clock_us + static_cast<std::uint32_t>(now_ns / kUs_ns);
}

std::vector<std::uint8_t> ColaEmulator::take_output(const devices::LineSettings& /*host*/,
                                                    std::int64_t now_ns) {
  return TurningEmulator::take_output(settings_.line, now_ns);
}

void ColaEmulator::receive(std::span<const std::uint8_t> bytes,
                           const devices::LineSettings& /*host*/, std::int64_t now_ns) {
  tick(now_ns);
  if (!on_ || now_ns < ready_ns_) return;
  for (const devices::ColaTelegram& command : reader_.read(bytes)) {
    if (command.dialect == settings_.dialect) obey(command, now_ns + settings_.answer_ns);
  }
}

void ColaEmulator::say(const devices::ColaTelegram& telegram, std::int64_t now_ns) {
  if (!is_silent()) answer(devices::cola_bytes(telegram), now_ns);
}

void ColaEmulator::obey(const devices::ColaTelegram& command, std::int64_t now_ns) {
  ColaWriter fields(settings_.dialect);
  if (command.name == "sRN DeviceIdent") {
    return say(fields.sized_text(settings_.name).sized_text("V1.0").telegram("sRA DeviceIdent"),
               now_ns);
  }
  if (command.name == "sMN SetAccessMode" || command.name == "sMN Run") {
    return say(fields.number(1, 1).telegram("sAN" + command.name.substr(3)), now_ns);
  }
  if (command.name == "sMN LMCstartmeas") {
    return say(fields.number(0, 1).telegram("sAN LMCstartmeas"), now_ns);
  }
  if (command.name != "sEN LMDscandata") {
    return say(fields.number(1, 2).telegram("sFA"), now_ns);
  }
  devices::ColaFields wanted(command);
  const std::uint32_t on = wanted.number(1);
  say(fields.number(on, 1).telegram("sEA LMDscandata"), now_ns);
  schedule(on == 0 ? kNever_ns : now_ns);
  if (on != 0) begin_sweep();
}

void ColaEmulator::begin_sweep() {
  constexpr double kSecond_ns = 1e9;
  const double turns_hz = turn_motor(settings_.beams);
  step_ns_ = kSecond_ns / turns_hz * settings_.step_deg / kColaTurn_deg;
  scan_ = {};
  scan_.start_us = clock_us(next_ns());
  scan_.turns_hz = turns_hz;
  scan_.first_deg = settings_.first_deg;
  scan_.step_deg = settings_.step_deg;
}

void ColaEmulator::send_packet() {
  const std::size_t done = scan_.ranges_m.size();
  const std::size_t count = std::min(kColaChunk, settings_.beams - done);
  const double first_deg =
      settings_.first_deg - kColaAhead_deg + static_cast<double>(done) * settings_.step_deg;
  for (const double reading_mm : measure_mm(first_deg, settings_.step_deg, count)) {
    scan_.ranges_m.push_back(static_cast<float>(0.001 * reading_mm));
  }
  const auto passed = static_cast<double>(count);
  if (scan_.ranges_m.size() < settings_.beams) {
    schedule(next_ns() + std::llround(passed * step_ns_));
    return;
  }
  scan_.sent_us = clock_us(next_ns());
  scan_.scan_counter = scans_++;
  scan_.status = status_;
  send(devices::cola_bytes(devices::cola_telegram(scan_, settings_.dialect)));
  count_turn();
  const double rest =
      kColaTurn_deg / settings_.step_deg - static_cast<double>(settings_.beams) + passed;
  schedule(next_ns() + std::llround(rest * step_ns_));
  begin_sweep();
}

}  // namespace topogeo::simulation
