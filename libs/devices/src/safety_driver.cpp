#include "topogeo/devices/safety_driver.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "sweep_layout.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kSafetyAnswer_ns = 2'000'000'000;
constexpr std::int64_t kSafetyMs_ns = 1'000'000;
constexpr std::uint32_t kDay_ms = 86'400'000;
constexpr std::uint32_t kLongestSafetyGap = 2000;  // data sets
constexpr std::uint32_t kLongestSafetyGap_ms = 60'000;
constexpr std::uint8_t kMostChannels = 4;
constexpr std::uint8_t kMostSafetyPaths = 20;
constexpr std::uint16_t kShortestTurn_ms = 10;
constexpr std::uint16_t kLongestTurn_ms = 500;
constexpr int kFailedSafetyStarts = 3;
constexpr std::uint8_t kSessionTimeout_s = 60;
constexpr double kSafetyAhead_deg = 90.0;
constexpr double kSafetyTurn_deg = 360.0;

bool off(std::uint32_t paths, std::uint8_t path) {
  return path != 0 && (paths >> (path - 1U) & 1U) == 0;
}

bool intruded(const SafetyScan& scan, std::uint8_t path) {
  return path != 0 && path <= scan.intruding.size() && scan.intruding[path - 1U] > 0;
}

/// Why the scans of a scanner in this state are of no use.
std::string fault_of(const SafetyState& state) {
  if (state.device_error) return "the laser reports an error";
  if (state.contamination_error) return "the window is too dirty";
  if (state.standby) return "the laser sleeps";
  return {};
}

std::uint16_t level_of(const SafetyState& state) {
  constexpr std::uint16_t kErrorLevel = 3;
  constexpr std::uint16_t kWarningLevel = 2;
  if (!fault_of(state).empty()) return kErrorLevel;
  const bool warns = state.application_error || state.contamination_warning ||
                     state.reference_contour || state.manipulated;
  return warns ? kWarningLevel : 0;
}

}  // namespace

SafetyDriver::SafetyDriver(const LaserModel& model, const TurningLaserSettings& turning,
                           const SafetySettings& settings)
    : model_(model),
      turning_(checked(turning)),
      settings_(settings),
      line_(line_of(model, turning)) {
  if (settings.channel >= kMostChannels || settings.protective_path > kMostSafetyPaths ||
      settings.warning_path > kMostSafetyPaths) {
    throw std::invalid_argument("safety scanner: expected channel 0 to 3 and paths 0 to 20, got " +
                                std::to_string(settings.channel) + ", " +
                                std::to_string(settings.protective_path) + " and " +
                                std::to_string(settings.warning_path));
  }
}

void SafetyDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}, {}}};
  starts_ = 0;
  host_address_ = 0;
  host_port_ = 0;
  start(now_ns);
}

void SafetyDriver::start(std::int64_t now_ns) {
  envelopes_.clear();
  replies_.clear();
  assembler_.clear();
  clock_.restart();
  if (last_) before_ = last_->sequence;
  last_.reset();
  running_ = false;
  refusal_.clear();
  ++starts_;
  state_ = starts_ > kFailedSafetyStarts ? LaserState::kFailed : LaserState::kStarting;
  reason_ = state_ == LaserState::kFailed
                ? "no data of a " + std::string(model_.title) +
                      ": is it on, and may it send to this computer (laser.data_port)?"
                : "asks for a " + std::string(model_.title);
  ask(Step::kOpen, now_ns);
}

void SafetyDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  state_ = LaserState::kOffline;
  reason_ = "the port is closed";
}

void SafetyDriver::end(std::int64_t /*now_ns*/) {
  // The scanner goes on sending: no telegram of the session is due any more.
  state_ = LaserState::kOffline;
  reason_ = "the program ends";
}

void SafetyDriver::send(char type, char mode, std::vector<std::uint8_t> data) {
  const Cola2Telegram telegram{session_, ++request_, type, mode, std::move(data)};
  orders_.push_back({std::nullopt, cola2_bytes(telegram), {}});
}

void SafetyDriver::ask(Step step, std::int64_t now_ns) {
  step_ = step;
  waits_since_ns_ = now_ns;
  if (step == Step::kOpen) {
    session_ = 0;
    send('O', 'X', {kSessionTimeout_s, 0, 0, 0, 1});
  } else if (step == Step::kConfigure) {
    send('M', 'I',
         safety_configuration({settings_.channel, static_cast<std::uint8_t>(settings_.interface),
                               host_address_, host_port_}));
  }
}

void SafetyDriver::take_host(std::span<const std::uint8_t> text) {
  const char* at = reinterpret_cast<const char*>(text.data());  // NOLINT: characters
  const char* const end = at + text.size();                     // NOLINT
  std::uint32_t address = 0;
  for (const char after : std::string_view("...:")) {
    std::uint8_t part = 0;
    const auto [next, error] = std::from_chars(at, end, part);
    if (error != std::errc() || next == end || *next != after) return;
    address = address << 8U | part;
    at = next + 1;  // NOLINT: within the text
  }
  std::uint16_t port = 0;
  if (std::from_chars(at, end, port).ec != std::errc()) return;
  host_address_ = address;
  host_port_ = port;
}

void SafetyDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (state_ == LaserState::kOffline) return;
  for (const Envelope& envelope : envelopes_.read(bytes)) {
    if (envelope.kind == EnvelopeKind::kHost) take_host(envelope.contents);
    if (envelope.kind == EnvelopeKind::kReply) {
      for (const Cola2Telegram& reply : replies_.read(envelope.contents)) take(reply, now_ns);
    }
    if (envelope.kind != EnvelopeKind::kDatagram) continue;
    const auto data = assembler_.add(envelope.contents);
    if (!data) continue;
    if (const auto scan = safety_scan(*data)) {
      take(*scan, now_ns);
    } else {
      ++implausible_;
    }
  }
}

void SafetyDriver::take(const Cola2Telegram& telegram, std::int64_t now_ns) {
  if (step_ == Step::kScans || telegram.request != request_) return;
  if (telegram.type == 'O' && telegram.mode == 'A' && step_ == Step::kOpen) {
    session_ = telegram.session;
    return ask(Step::kConfigure, now_ns);
  }
  const bool configured = telegram.type == 'A' && telegram.mode == 'I' && step_ == Step::kConfigure;
  if (!configured) {
    ++refused_;
    refusal_ = "the laser refuses the data output: another program may be connected to it";
    reason_ = refusal_;
  }
  // A data output that was set up before may come all the same.
  if (session_ != 0) send('C', 'X', {});
  ask(Step::kScans, now_ns);
}

bool SafetyDriver::follows(const SafetyScan& scan) const {
  if (!last_) return scan.sequence != before_;
  const std::uint32_t passed = scan.sequence - last_->sequence;
  const std::uint32_t passed_ms = (scan.time_ms + kDay_ms - last_->time_ms) % kDay_ms;
  return passed > 0 && passed <= kLongestSafetyGap && passed_ms > 0 &&
         passed_ms <= kLongestSafetyGap_ms;
}

bool SafetyDriver::fits(const SafetyScan& scan) {
  const std::size_t beams = turning_.beams != 0 ? turning_.beams : model_.beams;
  if (scan.beams.size() == beams) return true;
  ++other_beams_;
  state_ = LaserState::kFailed;
  reason_ = "it sends " + std::to_string(scan.beams.size()) + " beams, expected " +
            std::to_string(beams) + " of a " + std::string(model_.title) +
            " (laser.model, laser.beams, or the settings of the laser)";
  return false;
}

void SafetyDriver::take(const SafetyScan& scan, std::int64_t now_ns) {
  if (scan.channel != settings_.channel) {
    ++other_channel_;
    return;
  }
  const bool possible = scan.time_ms < kDay_ms && scan.step > 0 && scan.factor > 0 &&
                        scan.scan_time_ms >= kShortestTurn_ms &&
                        scan.scan_time_ms <= kLongestTurn_ms &&
                        std::abs(scan.first) <= kSafetyTurn_deg * kSafetyDegree &&
                        static_cast<double>(scan.step) * static_cast<double>(scan.beams.size()) <=
                            kSafetyTurn_deg * kSafetyDegree;
  if (!possible) {
    ++implausible_;
    return;
  }
  if (!follows(scan)) {
    ++repeated_;
    return;
  }
  waits_since_ns_ = now_ns;
  if (!fits(scan)) return;
  if (last_) {
    missed_ += scan.sequence - last_->sequence - 1;
    device_ns_ += kSafetyMs_ns * ((scan.time_ms + kDay_ms - last_->time_ms) % kDay_ms);
  }
  last_ = scan;
  last_->beams.clear();
  serial_number_ = scan.serial_number;
  step_ = Step::kScans;
  starts_ = 1;
  running_ = true;
  state_ = LaserState::kRunning;
  reason_.clear();
  LaserScan converted = to_scan(scan, now_ns);
  if (converted.stamp_ns <= last_stamp_ns_) {
    ++repeated_;
    return;
  }
  last_stamp_ns_ = converted.stamp_ns;
  scans_.push_back(std::move(converted));
}

LaserScan SafetyDriver::to_scan(const SafetyScan& scan, std::int64_t now_ns) {
  constexpr double kRad = std::numbers::pi / 180.0;
  constexpr double kPerMs_s = 0.001;
  constexpr double kSecond_ns = 1e9;
  const double step_deg = scan.step / kSafetyDegree;
  const double step_s = kPerMs_s * scan.scan_time_ms * step_deg / kSafetyTurn_deg;
  const auto gaps = static_cast<double>(scan.beams.size() - 1);
  const std::int64_t last_beam_ns = clock_.map(device_ns_, now_ns) - turning_.packet_delay_ns;
  LaserScan result;
  result.stamp_ns = last_beam_ns - std::llround(0.5 * gaps * step_s * kSecond_ns);
  Sweep sweep{kRad * (scan.first / kSafetyDegree - kSafetyAhead_deg), kRad * step_deg, step_s, {}};
  for (const SafetyBeam& beam : scan.beams) {
    sweep.ranges_m.push_back(range_m(scan, beam));
    if ((beam.status & kSafetyGlare) != 0) ++result.dazzled;
  }
  lay_out(std::move(sweep), turning_.upside_down, result);
  result.protective_field = intruded(scan, settings_.protective_path);
  result.warning_field = intruded(scan, settings_.warning_path);
  if (scan.state) {
    result.protective_field |= off(scan.state->safe_paths, settings_.protective_path);
    result.warning_field |= off(scan.state->other_paths, settings_.warning_path);
    result.contaminated = scan.state->contamination_warning || scan.state->contamination_error;
  }
  return result;
}

float SafetyDriver::range_m(const SafetyScan& scan, const SafetyBeam& beam) const {
  constexpr double kPerMm_m = 0.001;
  const double range_m = kPerMm_m * beam.distance * scan.factor;
  const bool measured = (beam.status & kSafetyValid) != 0 &&
                        (beam.status & (kSafetyInfinite | kSafetyGlare | kSafetyDirty)) == 0;
  const bool returned = measured && range_m >= turning_.range_min_m &&
                        range_m < turning_.largest_range_m(model_.range_max_m);
  return returned ? static_cast<float>(range_m) : 0.0F;
}

void SafetyDriver::tick(std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || now_ns < due_ns()) return;
  if (running_) ++silences_;
  start(now_ns);
}

std::int64_t SafetyDriver::due_ns() const {
  if (state_ == LaserState::kOffline) return std::numeric_limits<std::int64_t>::max();
  const bool scans = step_ == Step::kScans && running_;
  return waits_since_ns_ + (scans ? turning_.silence_ns : kSafetyAnswer_ns);
}

std::vector<LineOrder> SafetyDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> SafetyDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth SafetyDriver::health() const {
  constexpr double kSecond_ms = 1000.0;
  LaserHealth health;
  health.state = state_;
  health.reason = refusal_.empty() || running_ ? reason_ : refusal_;
  if (serial_number_ != 0) {
    health.device = std::string(model_.title) + ", serial number " + std::to_string(serial_number_);
  }
  health.line = line_;
  if (state_ == LaserState::kRunning && last_) {
    health.turns_hz = kSecond_ms / last_->scan_time_ms;
    if (last_->state) {
      const SafetyState& scanner = *last_->state;
      health.fault = fault_of(scanner);
      health.error_level = level_of(scanner);
      health.contaminated = scanner.contamination_warning || scanner.contamination_error;
    }
  }
  health.searches = silences_;
  health.drops = {{"bad checksum", envelopes_.bad_checksum()},
                  {"noise bytes", envelopes_.noise_bytes() + replies_.noise_bytes()},
                  {"implausible packet", implausible_ + assembler_.foreign()},
                  {"repeated packet", repeated_ + assembler_.repeated()},
                  {"missed scan", missed_},
                  {"incomplete scan", assembler_.incomplete()},
                  {"data of another channel", other_channel_},
                  {"refused by the laser", refused_},
                  {"other number of beams", other_beams_}};
  return health;
}

}  // namespace topogeo::devices
