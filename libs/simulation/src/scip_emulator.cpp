#include "topogeo/simulation/scip_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace topogeo::simulation {
namespace {

using devices::ScipAnswer;
using devices::ScipScanKind;

constexpr std::int64_t kScipEmulatorMs_ns = 1'000'000;
/// Steps that are measured at one instant.
constexpr unsigned kChunk = 24;
constexpr std::uint32_t kScipIntensity = 2000;
constexpr std::uint32_t kNothingInRange = 1;  // error code, below the least distance
constexpr std::size_t kLongestCommand = 64;

double turns_a_second(const devices::ScipParameters& sweep) {
  constexpr double kSeconds = 60.0;
  return sweep.rpm / kSeconds;
}

}  // namespace

ScipEmulator::ScipEmulator(const ScipEmulatorSettings& settings, Ranges ranges, std::int64_t now_ns)
    : TurningEmulator(settings.line,
                      {turns_a_second(settings.sweep),
                       turns_a_second(settings.sweep) * settings.sweep.steps_of_turn, 0.0, false},
                      0.001 * settings.sweep.range_max_mm, settings.seed, std::move(ranges)),
      settings_(settings),
      ready_ns_(now_ns) {}

void ScipEmulator::switch_off() {
  TurningEmulator::switch_off();
  on_ = false;
  request_.reset();
  command_.clear();
}

void ScipEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  on_ = true;
  asks_time_ = false;
  ready_ns_ = now_ns + settings_.start_up_ns;
}

std::uint32_t ScipEmulator::clock_ms(std::int64_t now_ns) const {
  return static_cast<std::uint32_t>((settings_.clock_ms + now_ns / kScipEmulatorMs_ns) %
                                    devices::kScipTimeWrap_ms);
}

std::vector<std::uint8_t> ScipEmulator::take_output(const devices::LineSettings& host,
                                                    std::int64_t now_ns) {
  return TurningEmulator::take_output(settings_.any_rate ? settings_.line : host, now_ns);
}

void ScipEmulator::receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
                           std::int64_t now_ns) {
  tick(now_ns);
  if (!on_ || now_ns < ready_ns_ || (!settings_.any_rate && host != settings_.line)) return;
  for (const std::uint8_t byte : bytes) {
    if (byte != '\n' && byte != '\r') {
      if (command_.size() < kLongestCommand) command_ += static_cast<char>(byte);
      continue;
    }
    if (!command_.empty()) obey(std::exchange(command_, {}), now_ns + settings_.answer_ns);
  }
}

void ScipEmulator::say(const std::string& text, std::int64_t now_ns) {
  if (!is_silent()) answer({text.begin(), text.end()}, now_ns);
}

void ScipEmulator::say_fields(const std::string& command, const devices::ScipFields& fields,
                              std::int64_t now_ns) {
  ScipAnswer answer{"00", {}};
  for (const auto& [name, value] : fields) {
    std::string& line = answer.lines.emplace_back(name);
    line += ':';
    line += value;
  }
  say(devices::scip_text_of_fields(command, answer), now_ns);
}

std::optional<devices::ScipScanRequest> ScipEmulator::scan_request(
    const std::string& command) const {
  for (const auto kind :
       {ScipScanKind::kTwoCharacters, ScipScanKind::kThreeCharacters, ScipScanKind::kIntensities}) {
    const devices::ScipScanRequest all{kind, settings_.sweep.first_step, settings_.sweep.last_step};
    if (command == devices::scip_command(all)) return all;
  }
  return std::nullopt;
}

void ScipEmulator::obey(const std::string& command, std::int64_t now_ns) {
  const auto status = [&](const char* code) {
    say(devices::scip_text(command, {code, {}}), now_ns);
  };
  if (command == "QT") {
    request_.reset();
    schedule(kNever_ns);
    return status("00");
  }
  if (command == "VV") {
    return say_fields(command,
                      {{"VEND", "Hokuyo Automatic Co., Ltd."},
                       {"PROD", settings_.sweep.model},
                       {"FIRM", "1.0.0(emulator)"},
                       {"PROT", "SCIP 2.0"},
                       {"SERI", "H0000001"}},
                      now_ns);
  }
  if (command == "PP") return say_fields(command, devices::scip_fields_of(settings_.sweep), now_ns);
  if (command == "II") {
    return say_fields(command, {{"MODL", settings_.sweep.model}, {"STAT", "normal"}}, now_ns);
  }
  if (settings_.answers_time && command == "TM1" && asks_time_) {
    return say(devices::scip_text(command, {"00", {devices::scip_encode(clock_ms(now_ns), 4)}}),
               now_ns);
  }
  if (settings_.answers_time && (command == "TM0" || command == "TM2")) {
    asks_time_ = command == "TM0";
    return status("00");
  }
  request_ = asks_time_ ? std::nullopt : scan_request(command);
  if (!request_) return status("0E");
  echo_ = command;
  status(trouble_.empty() ? "00" : trouble_.c_str());
  schedule(now_ns);
  begin_sweep();
}

void ScipEmulator::begin_sweep() {
  constexpr double kSecond_ns = 1e9;
  step_ns_ =
      kSecond_ns / (turn_motor(settings_.sweep.steps_of_turn) * settings_.sweep.steps_of_turn);
  step_ = settings_.sweep.first_step;
  scan_ = {clock_ms(next_ns() - std::llround(step_ * step_ns_)), {}, {}};
}

void ScipEmulator::send_packet() {
  const devices::ScipParameters& sweep = settings_.sweep;
  const unsigned count = std::min(kChunk, sweep.last_step + 1 - step_);
  const double step_deg = kTurn_deg / sweep.steps_of_turn;
  const double first_deg = (static_cast<double>(step_) - sweep.front_step) * step_deg;
  for (const double reading_mm : measure_mm(first_deg, step_deg, count)) {
    const bool nothing = reading_mm < sweep.range_min_mm;
    const auto distance_mm = nothing ? kNothingInRange : static_cast<std::uint32_t>(reading_mm);
    scan_.distances_mm.push_back(request_->kind == ScipScanKind::kTwoCharacters
                                     ? std::min(distance_mm, devices::kScipTwoCharacterMost)
                                     : distance_mm);
    scan_.intensities.push_back(nothing ? 0 : kScipIntensity);
  }
  step_ += count;
  if (step_ <= sweep.last_step) {
    schedule(next_ns() + std::llround(count * step_ns_));
    return;
  }
  end_sweep();
  const unsigned rest = sweep.steps_of_turn - (sweep.last_step - sweep.first_step + 1);
  schedule(next_ns() + std::llround((count + rest) * step_ns_));
  begin_sweep();
}

void ScipEmulator::end_sweep() {
  const ScipAnswer answer =
      trouble_.empty() ? devices::scip_answer_of(scan_, *request_) : ScipAnswer{trouble_, {}};
  const std::string text = devices::scip_text(echo_, answer);
  send({text.begin(), text.end()});
  if (trouble_.empty()) count_turn();
}

}  // namespace topogeo::simulation
