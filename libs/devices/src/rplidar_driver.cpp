#include "topogeo/devices/rplidar_driver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "topogeo/devices/line_time.hpp"

namespace topogeo::devices {
namespace {

constexpr std::int64_t kRpMs_ns = 1'000'000;
/// The Application Notes ask for 1 ms after a stop; what was under way arrives, too.
constexpr std::int64_t kStopTime_ns = 100 * kRpMs_ns;
constexpr std::int64_t kAnswerTime_ns = 500 * kRpMs_ns;
constexpr std::int64_t kSpinUp_ns = 500 * kRpMs_ns;
constexpr std::int64_t kFirstRest_ns = 500 * kRpMs_ns;
constexpr std::int64_t kLongestRest_ns = 5000 * kRpMs_ns;
constexpr int kRpTries = 3;
constexpr int kStartsUntilFailed = 3;
/// A packet of 32 points of a laser that turns 15 times a second spans 43 degrees.
constexpr double kLongestStep_deg = 60.0;
constexpr std::int64_t kLongestPacket_ns = 60 * kRpMs_ns;
/// After so many unusual widths in a row the laser has another speed.
constexpr int kFewWidths = 3;
/// No motor changes its speed by more from one packet to the next, which follows after 20 ms at
/// most.
constexpr double kSameWidth = 0.05;
constexpr double kSameWidth_deg = 0.3;
/// The clock by samples is wrong when it lags behind the arrival by more than a busy line delays.
constexpr std::int64_t kLargestLag_ns = 150 * kRpMs_ns;
constexpr std::uint8_t kStatusError = 2;
/// Series from which on the motor obeys requests.
constexpr std::uint8_t kFirstWithPwm = 2;
constexpr std::uint8_t kFirstWithSpeed = 6;
constexpr std::uint16_t kDefaultPwm = 660;
constexpr std::uint16_t kDefaultSpeedRpm = 600;

double step_deg(const RpPacket& packet, const RpPacket& next) {
  return (kRpTurnQ6 + next.start_q6 - packet.start_q6) % kRpTurnQ6 / 64.0;
}

}  // namespace

RpLidarDriver::RpLidarDriver(const LaserModel& model, const TurningLaserSettings& turning,
                             const RpLidarSettings& settings)
    : model_(model),
      turning_(checked(turning)),
      settings_(settings),
      line_(line_of(model, turning)),
      turns_(turning_, model.beams, model.range_max_m, true),
      reason_("the port is closed"),
      sample_ns_(std::llround(1e9 / (model.turns_hz * static_cast<double>(model.beams)))) {}

void RpLidarDriver::write(std::vector<std::uint8_t> bytes, std::optional<bool> dtr) {
  orders_.push_back({std::nullopt, std::move(bytes), dtr});
}

void RpLidarDriver::enter(Step step, std::int64_t due_ns) {
  if (step != step_) tries_ = 0;
  step_ = step;
  due_ns_ = due_ns;
}

void RpLidarDriver::opened(std::int64_t now_ns) {
  orders_ = {{line_, {}, {}}};
  failures_ = 0;
  start("the port was opened", now_ns);
}

void RpLidarDriver::lost(std::int64_t /*now_ns*/) {
  orders_.clear();
  reason_ = "the port is closed";
  enter(Step::kOffline, 0);
}

void RpLidarDriver::end(std::int64_t /*now_ns*/) {
  if (step_ == Step::kOffline) return;
  write(rp_request(rp_command::kStop));
  if (const auto command = motor_command()) write(rp_motor_request(*command, 0));
  if (settings_.motor != RpMotor::kNone) write({}, true);
  reason_ = "the program ends";
  enter(Step::kOffline, 0);
}

/// The adapter's DTR is low while its signal is set, and the motor of an A1 turns while it is high:
/// clearing it starts the motor.
void RpLidarDriver::start(const std::string& reason, std::int64_t now_ns) {
  reason_ = reason;
  pending_.reset();
  last_step_deg_ = 0.0;
  clock_.restart();
  turns_.restart();
  write(rp_request(rp_command::kStop),
        settings_.motor == RpMotor::kNone ? std::optional<bool>{} : std::optional<bool>{false});
  enter(Step::kStop, now_ns + kStopTime_ns);
}

void RpLidarDriver::ask(Step step, std::int64_t now_ns) {
  enter(step, now_ns + kAnswerTime_ns);
  switch (step) {
    case Step::kInfo:
      return write(rp_request(rp_command::kGetInfo));
    case Step::kHealth:
      return write(rp_request(rp_command::kGetHealth));
    case Step::kRate:
      return write(rp_request(rp_command::kGetSampleRate));
    case Step::kScan:
      return request_scan();
    default:
      return;
  }
}

void RpLidarDriver::request_scan() {
  decoder_.expect_descriptor();
  if (settings_.scan == RpScan::kStandard) return write(rp_request(rp_command::kScan));
  // The lasers with dense packets have them as their second mode.
  const bool dense = settings_.scan == RpScan::kModel && model_.family == "rplidar_dense";
  write(rp_express_request(dense ? std::uint8_t{1} : settings_.express_mode));
}

std::optional<std::uint8_t> RpLidarDriver::motor_command() const {
  const bool by_model = settings_.motor == RpMotor::kModel;
  if (settings_.motor == RpMotor::kSpeed || (by_model && series_ >= kFirstWithSpeed)) {
    return rp_command::kMotorSpeed;
  }
  if (settings_.motor == RpMotor::kPwm || (by_model && series_ >= kFirstWithPwm)) {
    return rp_command::kMotorPwm;
  }
  return std::nullopt;
}

void RpLidarDriver::start_motor() {
  const auto command = motor_command();
  if (!command) return;
  const std::uint16_t usual = *command == rp_command::kMotorPwm ? kDefaultPwm : kDefaultSpeedRpm;
  write(rp_motor_request(*command, settings_.motor_value > 0 ? settings_.motor_value : usual));
}

void RpLidarDriver::fail(const std::string& reason, std::int64_t now_ns) {
  ++starts_;
  ++failures_;
  reason_ = reason;
  const std::int64_t rest_ns = kFirstRest_ns << std::min(failures_ - 1, 4);
  enter(Step::kRest, now_ns + std::min(rest_ns, kLongestRest_ns));
}

void RpLidarDriver::receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (step_ == Step::kOffline || step_ == Step::kStop || step_ == Step::kRest) return;
  decoder_.push(bytes);
  while (const std::optional<RpDecoder::Answer> answer = decoder_.next()) {
    take(*answer, now_ns - line_time_ns(answer->bytes_since, line_));
    if (step_ == Step::kRest || step_ == Step::kStop) return;
  }
}

void RpLidarDriver::take(const RpDecoder::Answer& answer, std::int64_t arrival_ns) {
  const std::uint8_t type = answer.descriptor.type;
  if (step_ == Step::kInfo && type == rp_answer::kInfo) {
    const RpInfo info = rp_info(answer.data);
    device_ = "RPLIDAR, " + text_of(info);
    series_ = static_cast<std::uint8_t>(info.model >> 4);
    return ask(Step::kHealth, arrival_ns);
  }
  if (step_ == Step::kHealth && type == rp_answer::kHealth) {
    return take_health(answer.data, arrival_ns);
  }
  if (step_ == Step::kRate && type == rp_answer::kSampleRate) {
    const std::size_t at = settings_.scan == RpScan::kStandard ? 0 : 2;
    const int time_us = answer.data[at] | answer.data[at + 1] << 8;
    rate_known_ = time_us >= 10 && time_us <= 10'000;
    if (rate_known_) sample_ns_ = 1000LL * time_us;
    start_motor();
    return enter(Step::kSpinUp, arrival_ns + kSpinUp_ns);
  }
  if (step_ == Step::kScan && answer.descriptor.repeats && answer.data.empty()) {
    const bool decodes =
        type == rp_answer::kScan || type == rp_answer::kExpress || type == rp_answer::kDense;
    if (!decodes) {
      return fail("the laser answers in ultra packets: expected laser.express_mode 0", arrival_ns);
    }
    heard_ns_ = arrival_ns;
    return enter(Step::kRun, 0);
  }
  if (step_ != Step::kRun || answer.data.empty()) return;
  const std::int64_t sent_ns =
      arrival_ns - line_time_ns(answer.data.size(), line_) - turning_.packet_delay_ns;
  if (type == rp_answer::kScan) {
    if (const auto sample = rp_sample(answer.data)) take_sample(*sample, sent_ns);
  } else if (auto packet = rp_packet(answer.data, type)) {
    take_packet(*std::move(packet), answer.contiguous, sent_ns);
  }
}

void RpLidarDriver::take_health(std::span<const std::uint8_t> data, std::int64_t now_ns) {
  error_level_ = data[0] == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(data[0] + 1);
  if (data[0] < kStatusError) return ask(Step::kRate, now_ns);
  const int code = data[1] | data[2] << 8;
  write(rp_request(rp_command::kReset));
  fail("the laser reports an error, code " + std::to_string(code) + ": it was reset", now_ns);
}

void RpLidarDriver::take_sample(const RpSample& sample, std::int64_t at_ns) {
  if (at_ns - heard_ns_ > kLongestPacket_ns) begin_after_gap();
  heard_ns_ = at_ns;
  add_beam(sample.angle_q6 / 64.0, 0.25e-3 * sample.distance_q2, at_ns);
}

std::int64_t RpLidarDriver::time_of(const RpPacket& packet, std::int64_t sent_ns) {
  if (!rate_known_) return sent_ns;
  const std::int64_t packet_ns = static_cast<std::int64_t>(packet.points.size()) * sample_ns_;
  std::int64_t passed_ns = packet_ns;
  bool follows = false;
  if (pending_ && last_step_deg_ > 0.0) {
    const double packets = step_deg(pending_->packet, packet) / last_step_deg_;
    passed_ns = std::max<std::int64_t>(1, std::llround(packets)) * packet_ns;
    follows = std::llabs(sent_ns - pending_->sent_ns - passed_ns) <= kLongestPacket_ns;
  }
  if (!follows) clock_.restart();
  device_ns_ += passed_ns;
  const std::int64_t at_ns = clock_.map(device_ns_, sent_ns);
  if (sent_ns - at_ns <= kLargestLag_ns) return at_ns;
  clock_.restart();
  return clock_.map(device_ns_, sent_ns);
}

/// A packet counts if the next one follows it at once and begins about as far away as before: its
/// checksum alone would let one wrong packet of 256 pass.
void RpLidarDriver::take_packet(RpPacket packet, bool contiguous, std::int64_t sent_ns) {
  if (pending_ && pending_->packet == packet) {
    ++repeated_;
    return;
  }
  const std::int64_t last_sample_ns = time_of(packet, sent_ns);
  const std::optional<Pending> before =
      std::exchange(pending_, Pending{std::move(packet), last_sample_ns, sent_ns});
  if (!before) return;
  if (sent_ns - before->sent_ns > kLongestPacket_ns) return begin_after_gap();
  if (contiguous && has_usual_width(step_deg(before->packet, pending_->packet))) {
    add_packet(*before, pending_->packet.start_q6);
  }
}

bool RpLidarDriver::has_usual_width(double width_deg) {
  const bool possible = width_deg > 0.0 && width_deg <= kLongestStep_deg;
  const bool usual = possible && std::fabs(width_deg - last_step_deg_) <=
                                     kSameWidth * last_step_deg_ + kSameWidth_deg;
  if (usual || (possible && last_step_deg_ == 0.0)) last_step_deg_ = width_deg;
  doubts_ = usual ? 0 : doubts_ + 1;
  if (doubts_ >= kFewWidths) last_step_deg_ = 0.0;
  if (!usual) ++implausible_;
  return usual;
}

/// Nobody knows whether whole turns were lost.
void RpLidarDriver::begin_after_gap() {
  ++gaps_;
  turns_.restart();
}

void RpLidarDriver::add_packet(const Pending& pending, std::uint16_t next_start_q6) {
  heard_ns_ = pending.last_sample_ns;
  const std::size_t count = pending.packet.points.size();
  for (std::size_t k = 0; k < count; ++k) {
    const auto until_last = static_cast<std::int64_t>(count - 1 - k);
    add_beam(rp_angle_deg(pending.packet, next_start_q6, k, settings_.compensation_signed),
             1e-3 * pending.packet.points[k].distance_mm,
             pending.last_sample_ns - until_last * sample_ns_);
  }
}

void RpLidarDriver::add_beam(double angle_deg, double range_m, std::int64_t at_ns) {
  turns_.add({angle_deg * std::numbers::pi / 180.0, range_m, at_ns});
  if (std::optional<LaserScan> scan = turns_.take_scan()) {
    reason_.clear();
    failures_ = 0;
    scans_.push_back(*std::move(scan));
  }
}

void RpLidarDriver::tick(std::int64_t now_ns) {
  if (now_ns < RpLidarDriver::due_ns()) return;
  switch (step_) {
    case Step::kOffline:
      return;
    case Step::kStop:
      decoder_.expect_descriptor();
      return ask(Step::kInfo, now_ns);
    case Step::kInfo:
    case Step::kHealth:
    case Step::kScan:
      if (++tries_ < kRpTries) return ask(step_, now_ns);
      return fail("no answer at " + std::to_string(line_.baud) + " baud: is it a " +
                      std::string(model_.title) + " (laser.model)?",
                  now_ns);
    case Step::kRate:  // lasers with old firmware do not know the request
      start_motor();
      return enter(Step::kSpinUp, now_ns + kSpinUp_ns);
    case Step::kSpinUp:
      return ask(Step::kScan, now_ns);
    case Step::kRun:
      ++starts_;
      return start("no samples for " + std::to_string((now_ns - heard_ns_) / kRpMs_ns) + " ms",
                   now_ns);
    case Step::kRest:
      return start(reason_, now_ns);
  }
}

std::int64_t RpLidarDriver::due_ns() const {
  if (step_ == Step::kOffline) return std::numeric_limits<std::int64_t>::max();
  return step_ == Step::kRun ? heard_ns_ + turning_.silence_ns : due_ns_;
}

std::vector<LineOrder> RpLidarDriver::take_orders() {
  return std::exchange(orders_, {});
}

std::vector<LaserScan> RpLidarDriver::take_scans() {
  return std::exchange(scans_, {});
}

LaserHealth RpLidarDriver::health() const {
  LaserHealth health;
  const bool runs = step_ == Step::kRun && reason_.empty();
  health.state = step_ == Step::kOffline           ? LaserState::kOffline
                 : runs                            ? LaserState::kRunning
                 : failures_ >= kStartsUntilFailed ? LaserState::kFailed
                                                   : LaserState::kStarting;
  health.reason = reason_;
  health.device = device_;
  health.line = line_;
  health.error_level = error_level_;
  if (runs && last_step_deg_ > 0.0 && pending_) {
    const double samples_s = 1e-9 * static_cast<double>(sample_ns_) *
                             static_cast<double>(pending_->packet.points.size());
    health.turns_hz = last_step_deg_ / 360.0 / samples_s;
  }
  health.searches = starts_;
  health.drops = {{"bad checksum", decoder_.counters().bad_checksum},
                  {"noise bytes", decoder_.counters().noise_bytes},
                  {"implausible packet", implausible_},
                  {"repeated packet", repeated_},
                  {"gap in the samples", gaps_},
                  {"incomplete turn", turns_.incomplete()}};
  return health;
}

}  // namespace topogeo::devices
