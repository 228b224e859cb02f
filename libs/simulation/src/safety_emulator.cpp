#include "topogeo/simulation/safety_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace topogeo::simulation {
namespace {

/// Beams that are measured at one instant.
constexpr std::size_t kSafetyChunk = 24;
constexpr double kSafetyEmulatorTurn_deg = 360.0;
constexpr double kSafetyEmulatorAhead_deg = 90.0;
constexpr std::uint32_t kSafetySerialNumber = 20'210'001;
constexpr std::uint32_t kAllPaths = (1U << 20U) - 1U;

double step_deg(const SafetyEmulatorSettings& settings) {
  return settings.view_deg / static_cast<double>(settings.beams - 1);
}

std::string dotted(const devices::SafetyOutput& output) {
  std::string text;
  for (const unsigned shift : {24U, 16U, 8U, 0U}) {
    text += std::to_string(output.address >> shift & 0xFFU) + (shift == 0 ? ':' : '.');
  }
  return text + std::to_string(output.port);
}

}  // namespace

SafetyEmulator::SafetyEmulator(const SafetyEmulatorSettings& settings, Ranges ranges,
                               std::int64_t now_ns)
    : TurningEmulator(
          settings.line,
          {settings.turns_hz, settings.turns_hz * kSafetyEmulatorTurn_deg / step_deg(settings), 0.0,
           false},
          settings.range_max_m, settings.seed, std::move(ranges)),
      settings_(settings),
      ready_ns_(now_ns) {}

void SafetyEmulator::switch_off() {
  TurningEmulator::switch_off();
  on_ = false;
  reader_.clear();
}

void SafetyEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  on_ = true;
  ready_ns_ = now_ns + settings_.start_up_ns;
}

std::vector<std::uint8_t> SafetyEmulator::take_output(const devices::LineSettings& /*host*/,
                                                      std::int64_t now_ns) {
  return TurningEmulator::take_output(settings_.line, now_ns);
}

void SafetyEmulator::receive(std::span<const std::uint8_t> bytes,
                             const devices::LineSettings& /*host*/, std::int64_t now_ns) {
  tick(now_ns);
  if (!on_ || now_ns < ready_ns_) return;
  for (const devices::Cola2Telegram& command : reader_.read(bytes)) {
    obey(command, now_ns + settings_.answer_ns);
  }
}

void SafetyEmulator::say(devices::EnvelopeKind kind, std::span<const std::uint8_t> contents,
                         std::int64_t now_ns) {
  if (is_silent()) return;
  std::vector<std::uint8_t> bytes;
  devices::put_envelope(bytes, kind, contents);
  answer(std::move(bytes), now_ns);
}

void SafetyEmulator::obey(const devices::Cola2Telegram& command, std::int64_t now_ns) {
  devices::Cola2Telegram reply{command.session, command.request, 'F', 'A', {1, 0}};
  const bool in_session = command.session != 0 && command.session == sessions_;
  if (command.type == 'O' && command.mode == 'X') {
    reply = {++sessions_, command.request, 'O', 'A', {}};
  } else if (command.type == 'C' && in_session) {
    reply = {command.session, command.request, 'C', 'A', {}};
  } else if (const auto output = devices::safety_output(command.data);
             command.type == 'M' && in_session && output && !refusing_) {
    reply = {command.session, command.request, 'A', 'I', {}};
    output_ = *output;
    channel_ = output->channel;
    const std::string host = dotted(output_);
    say(devices::EnvelopeKind::kHost, std::vector<std::uint8_t>(host.begin(), host.end()), now_ns);
    if (next_ns() == kNever_ns) {
      schedule(now_ns);
      begin_sweep();
    }
  }
  say(devices::EnvelopeKind::kReply, devices::cola2_bytes(reply), now_ns);
}

void SafetyEmulator::begin_sweep() {
  constexpr double kSecond_ns = 1e9;
  constexpr double kSecond_ms = 1000.0;
  const double turns_hz = turn_motor(settings_.beams);
  step_ns_ = kSecond_ns / turns_hz * step_deg(settings_) / kSafetyEmulatorTurn_deg;
  scan_ = {};
  scan_.serial_number = kSafetySerialNumber;
  scan_.channel = channel_;
  scan_.scan_time_ms = static_cast<std::uint16_t>(std::lround(kSecond_ms / turns_hz));
  scan_.first =
      static_cast<std::int32_t>(std::lround(settings_.first_deg * devices::kSafetyDegree));
  scan_.step = static_cast<std::int32_t>(std::lround(step_deg(settings_) * devices::kSafetyDegree));
}

void SafetyEmulator::send_packet() {
  const std::size_t done = scan_.beams.size();
  const std::size_t count = std::min(kSafetyChunk, settings_.beams - done);
  const double first_deg = settings_.first_deg - kSafetyEmulatorAhead_deg +
                           static_cast<double>(done) * step_deg(settings_);
  for (const double reading_mm : measure_mm(first_deg, step_deg(settings_), count)) {
    const bool returned = reading_mm > 0.0;
    scan_.beams.push_back(
        {static_cast<std::uint16_t>(reading_mm),
         static_cast<std::uint8_t>(returned ? devices::kSafetyValid : devices::kSafetyInfinite)});
  }
  const auto passed = static_cast<double>(count);
  if (scan_.beams.size() < settings_.beams) {
    schedule(next_ns() + std::llround(passed * step_ns_));
    return;
  }
  end_sweep();
  const double rest =
      kSafetyEmulatorTurn_deg / step_deg(settings_) - static_cast<double>(settings_.beams) + passed;
  schedule(next_ns() + std::llround(rest * step_ns_));
  begin_sweep();
}

void SafetyEmulator::set_paths() {
  devices::SafetyState state = status_;
  state.safe_paths = kAllPaths;
  state.other_paths = kAllPaths;
  scan_.intruding.assign(2, 0);
  const double fields_m[] = {settings_.protective_field_m, settings_.warning_field_m};
  for (std::size_t path = 0; path < std::size(fields_m); ++path) {
    for (const devices::SafetyBeam& beam : scan_.beams) {
      const bool inside =
          (beam.status & devices::kSafetyValid) != 0 && 0.001 * beam.distance < fields_m[path];
      scan_.intruding[path] += inside ? 1 : 0;
    }
    if (scan_.intruding[path] == 0) continue;
    state.safe_paths &= ~(1U << path);
    state.other_paths &= ~(1U << path);
  }
  scan_.state = state;
}

void SafetyEmulator::end_sweep() {
  constexpr std::int64_t kMs_ns = 1'000'000;
  constexpr std::int64_t kDay_ms = 86'400'000;
  set_paths();
  ++scans_;
  scan_.sequence = scans_;
  scan_.scan = scans_;
  scan_.time_ms = static_cast<std::uint32_t>((settings_.clock_ms + next_ns() / kMs_ns) % kDay_ms);
  const std::vector<std::uint8_t> data = devices::safety_data(scan_);
  for (const std::vector<std::uint8_t>& datagram : devices::safety_datagrams(data, scans_)) {
    std::vector<std::uint8_t> bytes;
    devices::put_envelope(bytes, devices::EnvelopeKind::kDatagram, datagram);
    send(std::move(bytes));
  }
  count_turn();
}

}  // namespace topogeo::simulation
