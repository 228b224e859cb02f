// Maps the clock of a device to the clock of the host.
#pragma once

#include <cstdint>
#include <limits>

namespace topogeo::devices {

/// Maps a device's clock to the host's steady clock: messages are delayed by varying times but
/// never early, so the least delay of the last seconds shows the offset between the clocks.
class DeviceClock {
 public:
  /// How the offset follows the messages.
  struct Tracking {
    /// Long enough to contain a message with little delay, short enough to ignore the clocks'
    /// drift.
    std::int64_t window_ns = 5'000'000'000;
    /// The offset changes by at most 1 / slew_divisor of the device's time. That is faster than any
    /// two clocks drift apart, and too slow to show in a speed.
    std::int64_t slew_divisor = 50;
  };

  /// `transmission_ns`: time that even the least delayed message takes.
  explicit DeviceClock(std::int64_t transmission_ns) : DeviceClock(transmission_ns, Tracking()) {}
  DeviceClock(std::int64_t transmission_ns, const Tracking& tracking)
      : transmission_ns_(transmission_ns), tracking_(tracking) {}

  /// Host time of the device's time `device_ns`, for a message that arrived at `arrival_ns`.
  /// Results ascend strictly, for which one may be later than its arrival. The result runs faster
  /// or slower than the device's clock by at most 1 / Tracking::slew_divisor.
  std::int64_t map(std::int64_t device_ns, std::int64_t arrival_ns);
  /// Delay of a message relative to the least delayed messages; negative if it was delayed less
  /// than they were, which does not occur in the first seconds. 0 before the first message.
  [[nodiscard]] std::int64_t lateness_ns(std::int64_t device_ns, std::int64_t arrival_ns) const;
  /// Forgets the offset, because the device's clock has restarted.
  void restart() { started_ = false; }

 private:
  void settle(std::int64_t device_ns, std::int64_t offset_ns);

  std::int64_t transmission_ns_;
  Tracking tracking_;
  bool started_ = false;
  std::int64_t first_device_ns_ = 0;
  std::int64_t last_device_ns_ = 0;
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t offset_ns_ = 0;  // host time - device time, as applied
  std::int64_t least_ns_ = 0;   // least offset of this window
  std::int64_t before_ns_ = 0;  // least offset of the previous window
  std::int64_t window_ns_ = 0;  // start of this window, device time
};

}  // namespace topogeo::devices
