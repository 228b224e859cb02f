#include "topogeo/simulation/create_emulator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace topogeo::simulation {
namespace {

namespace order = devices::create_order;
using devices::CreateMode;

constexpr double kCleaning_m_s = 0.2;
constexpr std::int64_t kCreateMs_ns = 1'000'000;
/// A Roomba 690 sends 129 frames in 2 s, not 133.
constexpr std::int64_t kSlower = 133;
constexpr std::int64_t kStated = 129;

constexpr std::uint8_t kFirstOrder = 128;
constexpr std::uint8_t kFull = 132;
constexpr std::uint8_t kPower = 133;
constexpr std::uint8_t kSpot = 134;
constexpr std::uint8_t kClean = 135;
constexpr std::uint8_t kMax = 136;
constexpr std::uint8_t kDock = 143;
constexpr std::uint8_t kQueryList = 149;
constexpr std::uint8_t kPauseStream = 150;
constexpr std::uint8_t kButtons = 165;
constexpr std::uint8_t kStop = 173;
/// Clean, Spot and Dock of the order "buttons".
constexpr unsigned kMovingButtons = 7;

/// Orders with data of a fixed size.
struct OrderSize {
  std::uint8_t order;
  std::size_t bytes;
};
constexpr std::array<OrderSize, 18> kOrderSizes{{{129, 1},
                                                 {137, 4},
                                                 {138, 1},
                                                 {139, 3},
                                                 {141, 1},
                                                 {142, 1},
                                                 {144, 3},
                                                 {order::kDriveDirect, 4},
                                                 {146, 4},
                                                 {147, 1},
                                                 {kPauseStream, 1},
                                                 {151, 1},
                                                 {162, 2},
                                                 {163, 4},
                                                 {164, 4},
                                                 {kButtons, 1},
                                                 {167, 15},
                                                 {168, 3}}};

/// Bytes of data of the first order; empty until they are known.
std::optional<std::size_t> data_size(const std::deque<std::uint8_t>& orders) {
  if (orders.front() == order::kStream || orders.front() == kQueryList) {
    if (orders.size() < 2) return std::nullopt;
    return 1U + orders[1];
  }
  const auto* const size = std::ranges::find(kOrderSizes, orders.front(), &OrderSize::order);
  return size == kOrderSizes.end() ? 0U : size->bytes;
}

double speed_of(std::span<const std::uint8_t> data) {
  const auto speed = static_cast<std::int16_t>(data[0] << 8 | data[1]);
  return std::clamp<double>(speed, -devices::kCreateFastest, devices::kCreateFastest);
}

TwoWheelEmulatorSettings create_wheels(const CreateEmulatorSettings& settings) {
  return {.line = settings.line,
          .ticks_per_m = settings.wheels.ticks_per_m,
          .track_m = settings.wheels.track_m,
          .report_ns = devices::create_period_ms(settings.line) * kCreateMs_ns * kSlower / kStated,
          .seed = settings.seed};
}

}  // namespace

CreateEmulator::CreateEmulator(const CreateEmulatorSettings& settings, std::int64_t now_ns)
    : TwoWheelEmulator(create_wheels(settings)), create_(settings) {
  switch_on(now_ns);
}

void CreateEmulator::forget() {
  mode_ = CreateMode::kOff;
  streams_ = false;
  orders_.clear();
}

void CreateEmulator::obey(std::span<const std::uint8_t> bytes, std::int64_t /*now_ns*/) {
  orders_.insert(orders_.end(), bytes.begin(), bytes.end());
  while (!orders_.empty() && obey_first()) {
  }
}

bool CreateEmulator::obey_first() {
  if (orders_.front() < kFirstOrder) {
    orders_.pop_front();
    return true;
  }
  const std::optional<std::size_t> size = data_size(orders_);
  if (!size || orders_.size() < 1 + *size) return false;
  const std::uint8_t first = orders_.front();
  const auto end = orders_.begin() + static_cast<std::ptrdiff_t>(1 + *size);
  const std::vector<std::uint8_t> data(orders_.begin() + 1, end);
  orders_.erase(orders_.begin(), end);
  obey_order(first, data);
  return true;
}

void CreateEmulator::obey_order(std::uint8_t first, std::span<const std::uint8_t> data) {
  if (first == order::kStart) return become(CreateMode::kPassive);
  if (mode_ == CreateMode::kOff) return;
  const bool obeys = mode_ == CreateMode::kSafe || mode_ == CreateMode::kFull;
  switch (first) {
    case order::kSafe:
      if (mode_ == CreateMode::kPassive) become(CreateMode::kSafe);
      return check_safety();
    case kFull:
      return become(CreateMode::kFull);
    case order::kDriveDirect:
      if (obeys) drive(speed_of(data.subspan(2)), speed_of(data));
      return check_safety();
    case order::kStream: {
      // The emulator knows the packets of this driver only.
      const std::vector<std::uint8_t> known = devices::create_stream_request();
      streams_ = std::ranges::equal(data, std::span(known).subspan(1));
      return;
    }
    case kPauseStream:
      streams_ = streams_ && data[0] != 0;
      return;
    case kButtons:
      if ((data[0] & kMovingButtons) != 0) clean();
      return;
    case kSpot:
    case kClean:
    case kMax:
    case kDock:
      return clean();
    case kPower:
      return become(CreateMode::kPassive);
    case kStop:
      streams_ = false;
      return become(CreateMode::kOff);
    default:
      return;
  }
}

void CreateEmulator::drive(double left_mmps, double right_mmps) {
  want({1e-3 * left_mmps, 1e-3 * right_mmps});
}

void CreateEmulator::become(CreateMode mode) {
  mode_ = mode;
  drive(0.0, 0.0);
}

void CreateEmulator::clean() {
  become(CreateMode::kPassive);
  want({kCleaning_m_s, kCleaning_m_s});
}

void CreateEmulator::check_safety() {
  if (mode_ != CreateMode::kSafe) return;
  const bool ahead = wanted_mps()[0] + wanted_mps()[1] > 0.0;
  const bool cliff = std::ranges::find(seen_.cliffs, true) != seen_.cliffs.end();
  if (seen_.drop_left || seen_.drop_right || seen_.charger || seen_.dock || (cliff && ahead)) {
    become(CreateMode::kPassive);
  }
}

void CreateEmulator::hang_wheels(bool hang) {
  seen_.drop_left = seen_.drop_right = hang;
  check_safety();
}

void CreateEmulator::set_cliff(bool cliff) {
  seen_.cliffs[1] = cliff;
  check_safety();
}

void CreateEmulator::set_dock(bool dock) {
  seen_.dock = dock;
  seen_.cliffs.fill(dock);  // the dock lifts them off the floor
  seen_.charging = dock ? 2 : 0;
  check_safety();
}

void CreateEmulator::leave_safe_mode() {
  if (mode_ != CreateMode::kOff) become(CreateMode::kPassive);
}

/// The bumper covers the front. Bits count counter-clockwise from straight ahead, 22.5 degrees
/// each.
void CreateEmulator::press_bumpers(std::uint16_t pressed, std::int64_t /*now_ns*/) {
  constexpr unsigned kLeft = 0x800F;
  constexpr unsigned kRight = 0xF001;
  seen_.bump_left = (pressed & kLeft) != 0;
  seen_.bump_right = (pressed & kRight) != 0;
}

void CreateEmulator::report(std::int64_t now_ns) {
  if (!streams_) return;
  seen_.mode = static_cast<std::uint8_t>(static_cast<unsigned>(mode_) + create_.mode_offset);
  seen_.millivolts = static_cast<std::uint16_t>(std::lround(1e3 * create_.battery_v));
  seen_.charge_mah = create_.charge_mah;
  seen_.capacity_mah = create_.capacity_mah;
  for (std::size_t i = 0; i < 2; ++i) seen_.ticks[i] = static_cast<std::uint16_t>(ticks(i));
  say_report(devices::to_bytes(seen_), now_ns);
}

}  // namespace topogeo::simulation
