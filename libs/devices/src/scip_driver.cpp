#include "topogeo/devices/scip_driver.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sweep_layout.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kScipAnswer_ns = 500'000'000;
constexpr std::int64_t kScipRetry_ns = 2'000'000'000;
constexpr int kScipTries = 3;
constexpr int kTimeQuestions = 5;
constexpr std::uint64_t kFailedStarts = 3;
/// A laser turns within a tenth of its nominal speed, or as fast as its stamps say.
constexpr double kPeriodTolerance = 0.2;
/// Stamps have whole milliseconds, so the period is a mean over some turns.
constexpr double kPeriodWeight = 0.2;
constexpr double kScipSecond_ns = 1e9;

/// The first number of a status above which hardware is in trouble, and the last one.
constexpr std::string_view kFirstTrouble = "50";
constexpr std::string_view kLastTrouble = "97";

std::string joined(std::string_view product, std::string_view firmware, std::string_view serial) {
  std::string text(product);
  if (!firmware.empty()) text += ", firmware " + std::string(firmware);
  if (!serial.empty()) text += ", serial number " + std::string(serial);
  return text;
}

}  // namespace

ScipDriver::ScipDriver(const LaserModel& model, const TurningLaserSettings& turning,
                       const ScipSettings& settings)
    : model_(model),
      turning_(checked(turning)),
      settings_(settings),
      line_(line_of(model, turning)) {
  request_.kind = settings.kind;
}

void ScipDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}, {}}};
  failures_ = 0;
  start(now_ns);
}

void ScipDriver::start(std::int64_t now_ns) {
  reader_.clear();
  clock_.restart();
  times_ = 0;
  fault_.clear();
  wrong_model_.clear();
  error_level_ = 0;
  state_ = failures_ >= kFailedStarts ? LaserState::kFailed : LaserState::kStarting;
  reason_ = state_ == LaserState::kFailed ? "no answer of a " + std::string(model_.title) +
                                                ": is it connected and switched on?"
                                          : "asks for a " + std::string(model_.title);
  tries_ = 0;
  ask(Step::kProtocol, now_ns);
}

void ScipDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  state_ = LaserState::kOffline;
  reason_ = "the port is closed";
}

void ScipDriver::end(std::int64_t /*now_ns*/) {
  if (state_ == LaserState::kOffline) return;
  const std::string quit = command_of(Step::kQuit) + '\n';
  orders_.push_back({std::nullopt, {quit.begin(), quit.end()}, {}});
  state_ = LaserState::kOffline;
  reason_ = "the program ends";
}

std::string ScipDriver::command_of(Step step) const {
  switch (step) {
    case Step::kProtocol:
      return "SCIP2.0";
    case Step::kQuit:
      return "QT";
    case Step::kVersion:
      return "VV";
    case Step::kParameters:
      return "PP";
    case Step::kState:
      return "II";
    case Step::kTimeBegin:
      return "TM0";
    case Step::kTime:
      return "TM1";
    case Step::kTimeEnd:
      return "TM2";
    case Step::kMeasure:
    case Step::kScans:
      break;
  }
  return scip_command(request_);
}

bool ScipDriver::optional(Step step) {
  return step == Step::kProtocol || step == Step::kState || step == Step::kTimeBegin ||
         step == Step::kTime || step == Step::kTimeEnd;
}

void ScipDriver::ask(Step step, std::int64_t now_ns) {
  if (step != step_) tries_ = 0;
  step_ = step;
  command_ = command_of(step);
  asked_ns_ = heard_ns_ = now_ns;
  ++tries_;
  const std::string line = command_ + '\n';
  orders_.push_back({std::nullopt, {line.begin(), line.end()}, {}});
}

void ScipDriver::ask_next(std::int64_t now_ns) {
  if (step_ == Step::kTime && times_ < kTimeQuestions) return ask(Step::kTime, now_ns);
  ask(static_cast<Step>(static_cast<int>(step_) + 1), now_ns);
}

void ScipDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (state_ == LaserState::kOffline) return;
  for (const std::string& text : reader_.read(bytes)) take(text, now_ns);
}

void ScipDriver::take(const std::string& text, std::int64_t now_ns) {
  if (step_ == Step::kScans) return take_scan(text, now_ns);
  if (take_answer(text, now_ns)) return;
  if (step_ != Step::kProtocol && step_ != Step::kQuit) ++damaged_;
}

bool ScipDriver::take_answer(const std::string& text, std::int64_t now_ns) {
  if (step_ == Step::kVersion || step_ == Step::kParameters || step_ == Step::kState) {
    const auto fields = scip_fields(text, command_);
    if (!fields) return false;
    if (step_ == Step::kVersion) {
      device_ = joined(scip_field(*fields, "PROD"), scip_field(*fields, "FIRM"),
                       scip_field(*fields, "SERI"));
    } else if (step_ == Step::kParameters) {
      const auto sweep = scip_parameters(*fields);
      if (!sweep) return false;
      if (sweep->beams() != model_.beams) {
        wrong_model_ = "it is a " + sweep->model + " with " + std::to_string(sweep->beams()) +
                       " beams, expected a " + std::string(model_.title) + " with " +
                       std::to_string(model_.beams) + " (laser.model)";
        state_ = LaserState::kFailed;
        reason_ = wrong_model_;
        return true;
      }
      sweep_ = *sweep;
      request_.first_step = sweep_.first_step;
      request_.last_step = sweep_.last_step;
      period_ns_ = 60.0 * kScipSecond_ns / sweep_.rpm;
    }
    ask_next(now_ns);
    return true;
  }
  const auto answer = scip_answer(text, command_);
  if (!answer) return false;
  if (step_ == Step::kTime) {
    if (const auto time_ms = scip_time_ms(*answer)) clock_.answered(*time_ms, asked_ns_, now_ns);
    ++times_;
  } else if (step_ == Step::kTimeBegin && answer->status != "00") {
    step_ = Step::kTime;  // a laser without this command, or one that is in this mode already
    times_ = kTimeQuestions;
  } else if (step_ == Step::kMeasure) {
    if (answer->status != "00") {
      refuse(answer->status);
      return true;
    }
    step_ = Step::kScans;
    heard_ns_ = now_ns;
    return true;
  }
  ask_next(now_ns);
  return true;
}

void ScipDriver::refuse(const std::string& status) {
  ++refused_;
  const bool trouble = status >= kFirstTrouble && status <= kLastTrouble;
  fault_ = (trouble ? "hardware trouble, status " : "does not measure, status ") + status;
  error_level_ = trouble ? 4 : 2;
  reason_ = fault_;
}

void ScipDriver::take_scan(const std::string& text, std::int64_t now_ns) {
  const std::size_t echo_at = text.rfind(command_ + '\n');
  if (echo_at != std::string::npos) noise_bytes_ += echo_at;
  const auto answer = scip_answer(text, command_);
  if (!answer) {
    ++damaged_;
    return;
  }
  if (answer->status != "99") {
    if (answer->status != "00") refuse(answer->status);
    return;
  }
  const auto scan = scip_scan(*answer, request_);
  if (!scan) {
    ++damaged_;
    return;
  }
  std::optional<LaserScan> converted = to_scan(*scan, now_ns);
  if (!converted) {
    ++repeated_;
    return;
  }
  heard_ns_ = now_ns;
  failures_ = 0;
  state_ = LaserState::kRunning;
  reason_.clear();
  fault_.clear();
  error_level_ = 0;
  scans_.push_back(*std::move(converted));
}

void ScipDriver::measure_period() {
  const double nominal_ns = 60.0 * kScipSecond_ns / sweep_.rpm;
  const auto passed_ns = static_cast<double>(clock_.passed_ns());
  const double turns = std::round(passed_ns / nominal_ns);
  if (turns < 1.0) return;
  missed_ += static_cast<std::uint64_t>(turns) - 1;
  const double measured_ns = passed_ns / turns;
  if (std::fabs(measured_ns - nominal_ns) > kPeriodTolerance * nominal_ns) return;
  period_ns_ += kPeriodWeight * (measured_ns - period_ns_);
}

std::optional<LaserScan> ScipDriver::to_scan(const ScipScan& scan, std::int64_t now_ns) {
  const double step_ns = period_ns_ / sweep_.steps_of_turn;
  // Step 0 has the stamp, or the beam straight behind, half a turn before the front.
  const double first_steps =
      settings_.stamp == ScipStamp::kStepZero
          ? sweep_.first_step
          : sweep_.first_step + 0.5 * sweep_.steps_of_turn - sweep_.front_step;
  const auto beams = static_cast<double>(scan.distances_mm.size() - 1);
  const auto least_delay_ns = static_cast<std::int64_t>((first_steps + beams) * step_ns);
  const auto stamp_ns = clock_.stamp_ns(scan.time_ms, now_ns, least_delay_ns);
  if (!stamp_ns) return std::nullopt;
  measure_period();
  LaserScan result;
  result.stamp_ns =
      *stamp_ns + std::llround((first_steps + 0.5 * beams) * step_ns) - turning_.packet_delay_ns;
  if (result.stamp_ns <= last_stamp_ns_) return std::nullopt;
  last_stamp_ns_ = result.stamp_ns;
  const double step_rad = 2.0 * std::numbers::pi / sweep_.steps_of_turn;
  Sweep sweep{(static_cast<double>(sweep_.first_step) - sweep_.front_step) * step_rad,
              step_rad,
              step_ns / kScipSecond_ns,
              {}};
  for (std::size_t i = 0; i < scan.distances_mm.size(); ++i) {
    sweep.ranges_m.push_back(range_m(scan, i));
  }
  lay_out(std::move(sweep), turning_.upside_down, result);
  return result;
}

float ScipDriver::range_m(const ScipScan& scan, std::size_t beam) const {
  constexpr double kPerMm = 0.001;
  const double largest_m = turning_.largest_range_m(model_.range_max_m);
  const std::uint32_t distance_mm = scan.distances_mm[beam];
  const double range_m = kPerMm * distance_mm;
  const bool beyond =
      settings_.kind == ScipScanKind::kTwoCharacters && distance_mm >= kScipTwoCharacterMost;
  const bool weak = !scan.intensities.empty() && scan.intensities[beam] < settings_.least_intensity;
  // Numbers below the least distance are reasons for no return, larger ones than the largest, too.
  if (weak || beyond || distance_mm < sweep_.range_min_mm || distance_mm > sweep_.range_max_mm ||
      range_m < turning_.range_min_m || range_m >= largest_m) {
    return 0.0F;
  }
  return static_cast<float>(range_m);
}

void ScipDriver::fall_silent(std::int64_t now_ns) {
  if (state_ == LaserState::kRunning) ++silences_;
  ++failures_;
  start(now_ns);
}

void ScipDriver::tick(std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || now_ns < due_ns()) return;
  if (step_ == Step::kScans) return fall_silent(now_ns);
  if (refused()) return fall_silent(now_ns);
  if (step_ == Step::kTimeBegin || step_ == Step::kTime) return ask(Step::kTimeEnd, now_ns);
  if (optional(step_)) return ask_next(now_ns);
  if (tries_ < kScipTries) return ask(step_, now_ns);
  fall_silent(now_ns);
}

std::int64_t ScipDriver::due_ns() const {
  if (state_ == LaserState::kOffline) return std::numeric_limits<std::int64_t>::max();
  if (step_ == Step::kScans) return heard_ns_ + turning_.silence_ns;
  if (refused()) return asked_ns_ + kScipRetry_ns;
  return asked_ns_ + kScipAnswer_ns;
}

std::vector<LineOrder> ScipDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> ScipDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth ScipDriver::health() const {
  LaserHealth health;
  health.state = state_;
  health.reason = reason_;
  health.fault = fault_;
  health.device = device_;
  health.line = line_;
  health.error_level = error_level_;
  if (state_ == LaserState::kRunning) health.turns_hz = kScipSecond_ns / period_ns_;
  health.searches = silences_;
  health.drops = {{"bad checksum", damaged_},
                  {"noise bytes", noise_bytes_ + reader_.noise_bytes()},
                  {"repeated packet", repeated_},
                  {"missed scan", missed_},
                  {"refused by the laser", refused_}};
  return health;
}

}  // namespace topogeo::devices
