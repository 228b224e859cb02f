#include "topogeo/devices/cola_driver.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "sweep_layout.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kColaAnswer_ns = 1'000'000'000;
constexpr std::int64_t kColaUs_ns = 1000;
/// The motor of an LMS1xx needs this long until scans come.
constexpr std::int64_t kColaSpinUp_ns = 20'000'000'000;
constexpr std::uint32_t kLongestColaGap_us = 60'000'000;
constexpr std::uint32_t kLongestSweep_us = 500'000;
constexpr double kSlowestCola_hz = 1.0;
constexpr double kFastestCola_hz = 200.0;
constexpr int kFailedColaStarts = 4;
constexpr double kRadOfDegree = std::numbers::pi / 180.0;
constexpr double kAhead_deg = 90.0;

/// User level and the hash of its password ("client"), which SICK publishes for the start of a
/// measurement.
constexpr std::uint32_t kClient = 3;
constexpr std::uint32_t kClientHash = 0xF4724744;

constexpr std::uint8_t kColaError = 1;
constexpr std::uint8_t kColaDirty = 2;
constexpr std::uint8_t kColaTooDirty = 5;

LineOrder to_order(const ColaTelegram& telegram) {
  return {std::nullopt, cola_bytes(telegram), {}};
}

}  // namespace

ColaDriver::ColaDriver(const LaserModel& model, const TurningLaserSettings& turning,
                       const ColaSettings& settings)
    : model_(model),
      turning_(checked(turning)),
      settings_(settings),
      line_(line_of(model, turning)) {
  if (settings.dialect == ColaChoice::kBinary) dialect_ = ColaDialect::kBinary;
}

void ColaDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}, {}}};
  starts_ = 0;
  start(now_ns);
}

void ColaDriver::start(std::int64_t now_ns) {
  reader_.clear();
  clock_.restart();
  if (last_) before_us_ = last_->start_us;
  last_.reset();
  // The last start brought nothing: the laser may speak the other dialect.
  const bool failed = starts_ > 0 && !std::exchange(running_, false);
  status_ = 0;
  if (settings_.dialect == ColaChoice::kDetect && failed) {
    dialect_ = dialect_ == ColaDialect::kText ? ColaDialect::kBinary : ColaDialect::kText;
  }
  ++starts_;
  state_ = starts_ > kFailedColaStarts ? LaserState::kFailed : LaserState::kStarting;
  reason_ = state_ == LaserState::kFailed ? "no scan of a " + std::string(model_.title) +
                                                ": is it on, and does it speak CoLa (laser.cola)?"
                                          : "asks for a " + std::string(model_.title);
  ask(Step::kName, now_ns);
}

void ColaDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  state_ = LaserState::kOffline;
  reason_ = "the port is closed";
}

void ColaDriver::end(std::int64_t /*now_ns*/) {
  if (state_ == LaserState::kOffline) return;
  orders_.push_back(to_order(ColaWriter(dialect_).number(0, 1).telegram("sEN LMDscandata")));
  state_ = LaserState::kOffline;
  reason_ = "the program ends";
}

ColaTelegram ColaDriver::command_of(Step step) const {
  ColaWriter fields(dialect_);
  switch (step) {
    case Step::kName:
      return fields.telegram("sRN DeviceIdent");
    case Step::kLogIn:
      if (dialect_ == ColaDialect::kText) return {dialect_, "sMN SetAccessMode", "03 F4724744"};
      return fields.number(kClient, 1).number(kClientHash, 4).telegram("sMN SetAccessMode");
    case Step::kMeasure:
      return fields.telegram("sMN LMCstartmeas");
    case Step::kRun:
      return fields.telegram("sMN Run");
    case Step::kScans:
      break;
  }
  return fields.number(1, 1).telegram("sEN LMDscandata");
}

void ColaDriver::ask(Step step, std::int64_t now_ns) {
  step_ = step;
  waits_since_ns_ = now_ns;
  orders_.push_back(to_order(command_of(step)));
}

void ColaDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (state_ == LaserState::kOffline) return;
  for (const ColaTelegram& telegram : reader_.read(bytes)) take(telegram, now_ns);
}

void ColaDriver::take(const ColaTelegram& telegram, std::int64_t now_ns) {
  if (telegram.name == kColaScanName) {
    if (step_ == Step::kScans) take_scan(telegram, now_ns);
    return;
  }
  if (step_ == Step::kName && telegram.name == "sRA DeviceIdent") {
    ColaFields fields(telegram);
    const std::string name = fields.sized_text();
    const std::string version = fields.sized_text();
    device_ = fields.ok() ? name + ", firmware " + version : std::string();
    return ask(Step::kLogIn, now_ns);
  }
  if (step_ == Step::kScans) {
    // The laser answers, but an LMS1xx needs time until it measures.
    if (telegram.name == "sEA LMDscandata" && !running_) waits_since_ns_ = now_ns + kColaSpinUp_ns;
    return;
  }
  const std::string answered = "sAN" + command_of(step_).name.substr(3);
  const bool refused = telegram.name.starts_with("sFA") && step_ != Step::kName;
  // A laser that measures already may refuse; the scans decide.
  if (telegram.name == answered || refused) {
    ask(static_cast<Step>(static_cast<int>(step_) + 1), now_ns);
  }
}

bool ColaDriver::follows(const ColaScan& scan) const {
  if (!last_) return scan.start_us != before_us_;
  const std::uint32_t passed_us = scan.start_us - last_->start_us;
  return passed_us > 0 && passed_us <= kLongestColaGap_us;
}

void ColaDriver::take_scan(const ColaTelegram& telegram, std::int64_t now_ns) {
  const std::optional<ColaScan> scan = cola_scan(telegram);
  const bool possible = scan && scan->turns_hz >= kSlowestCola_hz &&
                        scan->turns_hz <= kFastestCola_hz &&
                        scan->sent_us - scan->start_us <= kLongestSweep_us;
  if (!possible) {
    ++implausible_;
    return;
  }
  if (!follows(*scan)) {
    ++repeated_;
    return;
  }
  const std::size_t beams = turning_.beams != 0 ? turning_.beams : model_.beams;
  if (scan->ranges_m.size() != beams) {
    ++other_beams_;
    state_ = LaserState::kFailed;
    reason_ = "it sends " + std::to_string(scan->ranges_m.size()) + " beams, expected " +
              std::to_string(beams) + " of a " + std::string(model_.title) +
              " (laser.model, laser.beams, or the settings of the laser)";
    waits_since_ns_ = now_ns;
    return;
  }
  if (last_) missed_ += static_cast<std::uint16_t>(scan->scan_counter - last_->scan_counter - 1);
  device_ns_ += last_ ? kColaUs_ns * (scan->sent_us - last_->sent_us) : 0;
  last_ = *scan;
  last_->ranges_m.clear();
  status_ = scan->status;
  turns_hz_ = scan->turns_hz;
  waits_since_ns_ = now_ns;
  starts_ = 1;
  running_ = true;
  state_ = LaserState::kRunning;
  reason_.clear();
  LaserScan converted = to_scan(*scan, now_ns);
  if (converted.stamp_ns <= last_stamp_ns_) {
    ++repeated_;
    return;
  }
  last_stamp_ns_ = converted.stamp_ns;
  scans_.push_back(std::move(converted));
}

LaserScan ColaDriver::to_scan(const ColaScan& scan, std::int64_t now_ns) {
  constexpr double kSecond_ns = 1e9;
  constexpr double kTurn_deg = 360.0;
  const std::int64_t sent_ns = clock_.map(device_ns_, now_ns);
  const std::int64_t first_ns = sent_ns - kColaUs_ns * (scan.sent_us - scan.start_us) +
                                settings_.zero_to_first_ns - turning_.packet_delay_ns;
  const double step_s = scan.step_deg / kTurn_deg / scan.turns_hz;
  const auto gaps = static_cast<double>(scan.ranges_m.size() - 1);
  LaserScan result;
  result.stamp_ns = first_ns + std::llround(0.5 * gaps * step_s * kSecond_ns);
  Sweep sweep{
      kRadOfDegree * (scan.first_deg - kAhead_deg), kRadOfDegree * scan.step_deg, step_s, {}};
  for (const float measured_m : scan.ranges_m) sweep.ranges_m.push_back(range_m(measured_m));
  lay_out(std::move(sweep), turning_.upside_down, result);
  result.contaminated = scan.status == kColaDirty || scan.status == kColaTooDirty;
  return result;
}

float ColaDriver::range_m(float measured_m) const {
  const double largest_m = turning_.largest_range_m(model_.range_max_m);
  const double range_m = measured_m;
  return range_m >= turning_.range_min_m && range_m < largest_m ? measured_m : 0.0F;
}

void ColaDriver::tick(std::int64_t now_ns) {
  if (state_ == LaserState::kOffline || now_ns < due_ns()) return;
  if (running_) ++silences_;
  start(now_ns);
}

std::int64_t ColaDriver::due_ns() const {
  if (state_ == LaserState::kOffline) return std::numeric_limits<std::int64_t>::max();
  return waits_since_ns_ + (step_ == Step::kScans ? turning_.silence_ns : kColaAnswer_ns);
}

std::vector<LineOrder> ColaDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> ColaDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth ColaDriver::health() const {
  LaserHealth health;
  health.state = state_;
  health.reason = reason_;
  health.device = device_;
  health.line = line_;
  health.contaminated = status_ == kColaDirty || status_ == kColaTooDirty;
  if (status_ == kColaError) health.fault = "the laser reports an error";
  if (status_ == kColaTooDirty) health.fault = "the window is too dirty";
  health.error_level = health.fault.empty() ? 0 : 3;
  if (state_ == LaserState::kRunning) health.turns_hz = turns_hz_;
  health.searches = silences_;
  health.drops = {{"bad checksum", reader_.bad_checksum()},
                  {"noise bytes", reader_.noise_bytes()},
                  {"implausible packet", implausible_},
                  {"repeated packet", repeated_},
                  {"missed scan", missed_},
                  {"other number of beams", other_beams_}};
  return health;
}

}  // namespace topogeo::devices
