#include "topogeo/devices/create_driver.hpp"

#include <algorithm>

namespace topogeo::devices {
namespace {

constexpr unsigned kCreateCountBits = 16;
constexpr std::int64_t kCreateMs_ns = 1'000'000;
constexpr std::int64_t kCreateTimeUnit_ns = 1000;
/// Frames that may have been under way when the device was started, and some more.
constexpr unsigned kFramesUntilPassive = 12;
/// Requests for the safe mode without effect until the device is started again.
constexpr unsigned kSafeRequests = 4;
constexpr std::int64_t kAskSafeAgain_ns = 500 * kCreateMs_ns;
constexpr std::uint16_t kCreateBumpRight = 1;
constexpr std::uint16_t kCreateBumpLeft = 2;

WheelUnits create_units(const CreateSettings& create) {
  return {.ticks_per_m = create.ticks_per_m,
          .track_m = create.track_m,
          .tick_bits = kCreateCountBits,
          .time_unit_ns = kCreateTimeUnit_ns};
}

/// A battery may hold more than its stated capacity.
std::optional<double> percent_of(const CreateReport& report) {
  if (report.capacity_mah == 0) return std::nullopt;
  return std::min(100.0, 100.0 * report.charge_mah / report.capacity_mah);
}

}  // namespace

CreateDriver::CreateDriver(const BaseSettings& settings)
    : TwoWheelDriver(settings, create_units(settings.create)),
      times_(create_period_ms(settings.line) * kCreateMs_ns) {}

std::vector<std::uint8_t> CreateDriver::stop_bytes() const {
  // A device that waits for the data of an order that was cut off takes the first bytes for them.
  std::vector<std::uint8_t> twice = create_drive(0.0, 0.0);
  const std::vector<std::uint8_t> once = twice;
  twice.insert(twice.end(), once.begin(), once.end());
  return twice;
}

/// A device whose last program was killed may move, and still sends its stream. The start order
/// would make it passive and hide that it had fallen there by itself, so it comes second.
void CreateDriver::ask(unsigned attempt, std::int64_t /*now_ns*/) {
  write(stop_bytes());
  if (attempt == 0) return;
  was_safe_ = false;
  frames_until_passive_ = kFramesUntilPassive;
  write({create_order::kStart});
  write(create_stream_request());
}

void CreateDriver::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  decoder_.push(bytes);
  std::vector<CreateReport> reports;
  while (const auto report = decoder_.next()) reports.push_back(*report);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const std::int64_t time_ns = times_.next(reports.size() - 1 - i, now_ns);
    if (frames_until_passive_ > 0 && --frames_until_passive_ == 0) learn_passive(reports[i].mode);
    if (passive_mode_ && frames_until_passive_ == 0) obey(reports[i], time_ns, now_ns);
  }
}

void CreateDriver::learn_passive(std::uint8_t mode) {
  const auto stated = static_cast<std::uint8_t>(CreateMode::kPassive);
  passive_mode_ = mode > stated ? static_cast<std::uint8_t>(stated + 1) : stated;
}

bool CreateDriver::obeys_speeds() const {
  return passive_mode_ && mode_ > *passive_mode_;
}

CreateDriver::Signs CreateDriver::signs_of(const CreateReport& report) const {
  Signs signs;
  if (report.bump_right) signs.bumpers |= kCreateBumpRight;
  if (report.bump_left) signs.bumpers |= kCreateBumpLeft;
  const bool fell = was_safe_ && !obeys_speeds();
  if (report.drop_left || report.drop_right) {
    signs.emergency_stop = kWheelHangs;
  } else if (charger_ && fell) {
    signs.emergency_stop = "the drive unit is on its charger: take it off and release it";
  } else if (!charger_ && std::ranges::find(report.cliffs, true) != report.cliffs.end()) {
    // A dock lifts the sensors off the floor.
    signs.emergency_stop = kNoFloor;
  } else if (fell) {
    signs.emergency_stop = "the drive unit has left its safe mode; release it";
  }
  return signs;
}

void CreateDriver::obey(const CreateReport& report, std::int64_t time_ns, std::int64_t now_ns) {
  if (!runs()) greet(now_ns);
  mode_ = report.mode;
  charger_ = report.charger || report.dock;
  set_battery(1e-3 * report.millivolts, percent_of(report));
  const Signs signs = signs_of(report);
  was_safe_ = (was_safe_ || obeys_speeds()) && !signs.emergency_stop;
  take({.time = static_cast<std::uint32_t>(time_ns / kCreateTimeUnit_ns),
        .ticks = {report.ticks[0], report.ticks[1]}},
       signs, now_ns);
  want_safe_mode(now_ns);
}

void CreateDriver::want_safe_mode(std::int64_t now_ns) {
  // On its charger the device would stop charging and fall back.
  if (obeys_speeds()) safe_requests_ = 0;
  if (obeys_speeds() || charger_ || stopped()) return;
  if (now_ns < asked_safe_ns_ + kAskSafeAgain_ns) return;
  asked_safe_ns_ = now_ns;
  if (++safe_requests_ % kSafeRequests == 0) {
    // The start order was lost, and the number of the passive mode is wrong.
    frames_until_passive_ = kFramesUntilPassive;
    write({create_order::kStart});
    return;
  }
  write({create_order::kSafe});
}

void CreateDriver::released(std::int64_t now_ns) {
  asked_safe_ns_ = now_ns - kAskSafeAgain_ns;
}

std::string_view CreateDriver::hindrance() const {
  if (obeys_speeds()) return {};
  return charger_ ? "the drive unit is on its charger: take it off"
                  : "the drive unit does not go to its safe mode";
}

void CreateDriver::write_speeds(const BaseVelocity& velocity) {
  const double side_mps = 0.5 * units().track_m * velocity.angular_radps;
  write(
      create_drive(1e3 * (velocity.linear_mps - side_mps), 1e3 * (velocity.linear_mps + side_mps)));
}

void CreateDriver::count_drops(McpDrops& drops) const {
  count_of(drops, McpDrop::kChecksum) = decoder_.counters().bad_checksum;
  count_of(drops, McpDrop::kGarbage) = decoder_.counters().noise_bytes;
  count_of(drops, McpDrop::kBadReport) = decoder_.counters().bad_fields;
}

}  // namespace topogeo::devices
