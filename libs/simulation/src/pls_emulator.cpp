#include "topogeo/simulation/pls_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace topogeo::simulation {
namespace {

using devices::PlsMode;

/// Bytes further apart do not form a command.
constexpr std::int64_t kByteGap_ns = 35'000'000;
constexpr std::uint8_t kPermanentBaud = 0x66;
constexpr std::uint8_t kScanWhole = 0x01;
constexpr std::uint8_t kReplyBit = 0x80;
constexpr std::size_t kStatusReport_bytes = 152;
constexpr std::uint64_t kMostGarbage_bytes = 200;
constexpr std::uint64_t kFirstAfterHeader = 7;
/// More scans than the longest fault can affect.
constexpr int kForEver = 1'000'000'000;
/// Bit in the status byte of a PLS (SICK LMS quick manual, telegram listing).
constexpr std::uint8_t kPolluted = 0x80;

PlsFault pls_fault(LaserFault fault) {
  switch (fault) {
    case LaserFault::kBadChecksum:
      return PlsFault::kBadCrc;
    case LaserFault::kTruncated:
      return PlsFault::kTruncated;
    case LaserFault::kStuckScan:
      return PlsFault::kStuckScan;
    case LaserFault::kGarbage:
    case LaserFault::kDoubled:  // noise, too: a telegram that no command asked for
      break;
  }
  return PlsFault::kGarbage;
}

void put_word(std::vector<std::uint8_t>& bytes, std::size_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFFU));
  bytes.push_back(static_cast<std::uint8_t>(word >> 8 & 0xFFU));
}

std::uint16_t code_of(float range_m, std::uint16_t no_return_code) {
  if (!std::isfinite(range_m) || range_m <= 0.0F) return no_return_code;
  const double range_cm = std::floor(static_cast<double>(range_m) * 100.0 + 0.5);
  return range_cm < no_return_code ? static_cast<std::uint16_t>(range_cm) : no_return_code;
}

}  // namespace

PlsEmulator::PlsEmulator(PlsEmulatorSettings settings, Ranges ranges, std::int64_t now_ns)
    : settings_(std::move(settings)),
      ranges_(std::move(ranges)),
      line_(settings_.power_on),
      decoder_(devices::SickDecoder::Listener::kSensor, kByteGap_ns),
      random_(settings_.seed),
      mirror_ns_(now_ns) {
  if (settings_.mirror_period_ns <= 0 || settings_.power_on.baud == 0 || !ranges_) {
    throw std::invalid_argument(
        "an emulated laser needs a mirror period and a rate above 0, and ranges to measure");
  }
  set_fields(settings_.protective_field_m, settings_.warning_field_m);
}

void PlsEmulator::receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
                          std::int64_t now_ns) {
  tick(now_ns);
  if (power_ != Power::kOn || silent_ || host != line_) {
    decoder_.clear();
    return;
  }
  const std::uint64_t bad_before = decoder_.counters().bad_crc;
  decoder_.push(bytes, now_ns);
  while (const std::optional<devices::SickEvent> event = decoder_.next()) {
    if (now_ns >= busy_until_ns_) obey(event->telegram, now_ns);
  }
  if (decoder_.counters().bad_crc != bad_before && now_ns >= busy_until_ns_) {
    output_.send({devices::kSickNak}, line_, now_ns + settings_.ack_delay_ns);
  }
}

void PlsEmulator::tick(std::int64_t now_ns) {
  if (power_ == Power::kStarting && now_ns >= start_up_end_ns_) finish_start_up(now_ns);
  if (change_ && now_ns >= change_->at_ns) {
    const Change change = *std::exchange(change_, std::nullopt);
    apply(change, now_ns);
  }
  if (measure_at_ns_ && now_ns >= *measure_at_ns_) measure(now_ns);
}

std::int64_t PlsEmulator::due_ns() const {
  std::int64_t due_ns = std::numeric_limits<std::int64_t>::max();
  if (power_ == Power::kStarting) due_ns = start_up_end_ns_;
  if (change_) due_ns = std::min(due_ns, change_->at_ns);
  if (measure_at_ns_) due_ns = std::min(due_ns, *measure_at_ns_);
  return due_ns;
}

std::vector<std::uint8_t> PlsEmulator::take_output(const devices::LineSettings& host,
                                                   std::int64_t now_ns) {
  return output_.take(host, now_ns);
}

void PlsEmulator::switch_off() {
  power_ = Power::kOff;
  mode_ = Mode::kOnRequest;
  output_.clear();
  decoder_.clear();
  change_.reset();
  measure_at_ns_.reset();
  last_scan_.clear();
  busy_until_ns_ = 0;
}

void PlsEmulator::switch_on(std::int64_t now_ns) {
  switch_off();
  power_ = Power::kStarting;
  start_up_end_ns_ = now_ns + settings_.start_up_ns;
  fault_end_ns_ = std::max(fault_end_ns_, start_up_end_ns_);
}

void PlsEmulator::set_up(std::uint32_t baud, bool streaming, std::int64_t now_ns) {
  line_.baud = baud;
  mode_ = streaming ? Mode::kStream : Mode::kOnRequest;
  if (streaming) measure_at_ns_ = now_ns;
}

void PlsEmulator::inject(PlsFault fault, int count) {
  pending_[static_cast<std::size_t>(fault)] += count;
}

void PlsEmulator::set_fault(LaserFault fault, bool on) {
  const PlsFault own = pls_fault(fault);
  inject(own, (on ? kForEver : 0) - pending(own));
}

void PlsEmulator::set_contaminated(bool contaminated) {
  set_status(contaminated ? kPolluted : std::uint8_t{0});
}

void PlsEmulator::fall_silent(std::int64_t now_ns) {
  tick(now_ns);
  output_.clear();
  decoder_.clear();
  silent_ = true;
}

void PlsEmulator::speak_again(std::int64_t now_ns) {
  tick(now_ns);
  silent_ = false;
  fault_end_ns_ = std::max(fault_end_ns_, now_ns);
}

int PlsEmulator::pending(PlsFault fault) const {
  return pending_[static_cast<std::size_t>(fault)];
}

/// Carries out a command: ACK, the reply, and its effects.
void PlsEmulator::obey(const devices::SickTelegram& command, std::int64_t now_ns) {
  const std::int64_t acknowledged_ns =
      output_.send({devices::kSickAck}, line_, now_ns + settings_.ack_delay_ns);
  const std::int64_t reply_ns = acknowledged_ns + settings_.reply_delay_ns;
  const bool for_scan = command.code == devices::pls_command::kRequestScan &&
                        command.data.size() == 1 && command.data[0] == kScanWhole &&
                        mode_ != Mode::kInstallation;
  if (for_scan && mode_ == Mode::kOnRequest) {
    const std::int64_t period_ns = settings_.mirror_period_ns;
    const std::int64_t turns = (reply_ns - mirror_ns_ + period_ns - 1) / period_ns;
    measure_at_ns_ = mirror_ns_ + turns * period_ns;
    busy_until_ns_ = *measure_at_ns_ + settings_.sweep_to_send_ns;
    return;
  }
  Reply reply = answer(command);
  // No new scan starts before the reply to a command that may end the scans.
  if (reply.then.mode && mode_ == Mode::kStream) measure_at_ns_.reset();
  busy_until_ns_ = send_telegram(devices::sick_reply(reply.code, reply.data, status_), reply_ns);
  change_ = reply.then;
  change_->at_ns = busy_until_ns_;
}

PlsEmulator::Reply PlsEmulator::answer(const devices::SickTelegram& command) {
  switch (command.code) {
    case devices::pls_command::kMode:
      return change_mode(command.data);
    case devices::pls_command::kRequestStatus:
      return {devices::pls_reply::kStatus, status_report(), {}};
    case devices::pls_command::kRequestErrors:
      return {devices::pls_reply::kErrors, error_list(), {}};
    case devices::pls_command::kReset: {
      Change change;
      change.restart = true;
      return {devices::pls_reply::kReset, {}, change};
    }
    case kPermanentBaud:
      if (command.data.size() != 1) break;
      rate_is_permanent_ = command.data[0] == 1;
      return {static_cast<std::uint8_t>(kPermanentBaud | kReplyBit), {0}, {}};
    default:
      break;
  }
  return {devices::pls_reply::kNotAcknowledged, {}, {}};
}

PlsEmulator::Reply PlsEmulator::change_mode(std::span<const std::uint8_t> data) {
  const auto reply = [](devices::PlsModeReply result, std::optional<Mode> mode) {
    Change change;
    change.mode = mode;
    return Reply{devices::pls_reply::kMode, {static_cast<std::uint8_t>(result)}, change};
  };
  Reply refused = reply(devices::PlsModeReply::kRefused, std::nullopt);
  if (data.empty()) return refused;
  if (data.size() == 1 && data[0] == static_cast<std::uint8_t>(PlsMode::kOnRequest)) {
    return reply(devices::PlsModeReply::kDone, Mode::kOnRequest);
  }
  // The stream must be stopped before any other setting.
  if (mode_ == Mode::kStream) return refused;
  if (data[0] == static_cast<std::uint8_t>(PlsMode::kInstallation)) {
    const bool right = std::ranges::equal(data.subspan(1), settings_.password, {}, {},
                                          [](char c) { return static_cast<std::uint8_t>(c); });
    return right ? reply(devices::PlsModeReply::kDone, Mode::kInstallation) : refused;
  }
  if (data.size() != 1) return refused;
  if (data[0] == static_cast<std::uint8_t>(PlsMode::kStream)) {
    return reply(devices::PlsModeReply::kDone, Mode::kStream);
  }
  const std::optional<std::uint32_t> baud = devices::pls_baud_of(data[0]);
  return baud ? change_rate(*baud) : refused;
}

PlsEmulator::Reply PlsEmulator::change_rate(std::uint32_t baud) {
  const bool lms = settings_.power_on.parity == devices::Parity::kNone;
  const bool allowed = lms || settings_.rate_in_any_mode || mode_ == Mode::kInstallation;
  Reply reply{devices::pls_reply::kMode, {}, {}};
  reply.data.push_back(static_cast<std::uint8_t>(allowed ? devices::PlsModeReply::kDone
                                                         : devices::PlsModeReply::kRefused));
  if (allowed && !strikes(PlsFault::kIgnoreBaudSwitch)) reply.then.baud = baud;
  return reply;
}

std::vector<std::uint8_t> PlsEmulator::status_report() const {
  std::vector<std::uint8_t> data(settings_.software.begin(), settings_.software.end());
  data.resize(kStatusReport_bytes);
  const std::uint16_t code = devices::pls_status_baud_code(line_.baud).value_or(0);
  data[devices::kPlsStatusBaudAt] = static_cast<std::uint8_t>(code & 0xFFU);
  data[devices::kPlsStatusBaudAt + 1] = static_cast<std::uint8_t>(code >> 8);
  return data;
}

std::vector<std::uint8_t> PlsEmulator::error_list() const {
  std::vector<std::uint8_t> data;
  for (const devices::PlsError& error : settings_.errors) {
    data.push_back(static_cast<std::uint8_t>(error.severity));
    data.push_back(error.number);
  }
  if (data.empty()) data = {0, 0};
  return data;
}

void PlsEmulator::apply(const Change& change, std::int64_t now_ns) {
  if (change.restart) {
    switch_on(now_ns);
    return;
  }
  if (change.baud) line_.baud = *change.baud;
  if (!change.mode) return;
  mode_ = *change.mode;
  if (mode_ == Mode::kStream) measure_at_ns_ = now_ns;
}

void PlsEmulator::finish_start_up(std::int64_t now_ns) {
  power_ = Power::kOn;
  mirror_ns_ = now_ns;
  if (!rate_is_permanent_) line_ = settings_.power_on;
  const std::vector<std::uint8_t> text(settings_.power_on_text.begin(),
                                       settings_.power_on_text.end());
  busy_until_ns_ =
      send_telegram(devices::sick_reply(devices::pls_reply::kPowerOn, text, status_), now_ns);
}

/// Takes a scan in the middle of the mirror's sweep, whose telegram starts some time later, and in
/// a stream plans the next one: with the mirror's next turn, or when the line will be free.
void PlsEmulator::measure(std::int64_t now_ns) {
  const std::int64_t planned_ns = *std::exchange(measure_at_ns_, std::nullopt);
  const int stuck_before = pending(PlsFault::kStuckScan);
  const std::int64_t free_ns = send_telegram(
      devices::sick_reply(devices::pls_reply::kMeasuredValues, scan_data(now_ns), status_),
      now_ns + settings_.sweep_to_send_ns);
  if (pending(PlsFault::kStuckScan) != stuck_before)
    fault_end_ns_ = std::max(fault_end_ns_, free_ns);
  if (!silent_) ++scans_sent_;
  if (mode_ != Mode::kStream) return;
  const std::int64_t turn_ns = planned_ns + settings_.mirror_period_ns;
  measure_at_ns_ = std::max({turn_ns, free_ns - settings_.sweep_to_send_ns, now_ns + 1});
}

void PlsEmulator::set_fields(double protective_m, double warning_m) {
  constexpr double kFarthestProtective_m = 4.0;
  constexpr double kFarthestWarning_m = 15.0;
  if (!(protective_m >= 0.0 && protective_m <= kFarthestProtective_m && warning_m >= 0.0 &&
        warning_m <= kFarthestWarning_m)) {
    throw std::invalid_argument(
        "an emulated laser has a protective field of 0 to 4 m and a warning field of 0 to 15 m");
  }
  settings_.protective_field_m = protective_m;
  settings_.warning_field_m = warning_m;
}

std::uint16_t PlsEmulator::field_bits(float range_m) const {
  constexpr std::uint16_t kWarning = 1U << 14;
  constexpr std::uint16_t kProtective = 1U << 15;
  if (!(range_m > 0.0F)) return 0;
  const auto range = static_cast<double>(range_m);
  std::uint16_t bits = 0;
  if (range <= settings_.warning_field_m) bits |= kWarning;
  if (range <= settings_.protective_field_m) bits |= kProtective;
  return bits;
}

std::vector<std::uint8_t> PlsEmulator::scan_data(std::int64_t now_ns) {
  if (!last_scan_.empty() && strikes(PlsFault::kStuckScan)) return last_scan_;
  const std::vector<float> ranges_m = ranges_(now_ns);
  std::vector<std::uint8_t> data;
  put_word(data, ranges_m.size());
  for (const float range_m : ranges_m) {
    put_word(data, code_of(range_m, settings_.no_return_code) | field_bits(range_m));
  }
  last_scan_ = data;
  return data;
}

/// Sends a telegram with its pending faults; returns when it will have left.
std::int64_t PlsEmulator::send_telegram(std::vector<std::uint8_t> telegram, std::int64_t start_ns) {
  if (silent_) return start_ns;
  bool struck = false;
  if (strikes(PlsFault::kBadCrc)) {
    struck = true;
    // The header stays intact, because the check of the length has its own tests.
    const std::uint64_t at = kFirstAfterHeader + random_.below(telegram.size() - kFirstAfterHeader);
    telegram[at] ^= static_cast<std::uint8_t>(1U << random_.below(8));
  }
  if (strikes(PlsFault::kTruncated)) {
    struck = true;
    telegram.resize(1 + random_.below(telegram.size() - 1));
  }
  if (strikes(PlsFault::kGarbage)) {
    struck = true;
    std::vector<std::uint8_t> garbage(1 + random_.below(kMostGarbage_bytes));
    for (std::uint8_t& byte : garbage) byte = static_cast<std::uint8_t>(random_.below(256));
    telegram.insert(telegram.end(), garbage.begin(), garbage.end());
  }
  const std::int64_t free_ns = output_.send(std::move(telegram), line_, start_ns);
  if (struck) fault_end_ns_ = std::max(fault_end_ns_, free_ns);
  return free_ns;
}

bool PlsEmulator::strikes(PlsFault fault) {
  int& pending = pending_[static_cast<std::size_t>(fault)];
  if (pending == 0) return false;
  --pending;
  return true;
}

}  // namespace topogeo::simulation
