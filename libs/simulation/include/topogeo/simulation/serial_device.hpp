// An emulated device at the other end of a serial line: bytes in, bytes out, no port and no clock
// of its own. See devices/serial_driver.hpp for the host's end.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::simulation {

/// Longest time that an emulated device catches up after its process waited for a CPU. The world
/// stands still for the rest of the wait, because a robot that runs on blindly would hit something.
/// The device obeys the commands of the wait after that standstill, so it obeys them early by at
/// most this time. A driver would take a larger error for a base without power.
inline constexpr std::int64_t kLongestCatchUp_ns = 50'000'000;

/// Times are nanoseconds of the simulated world's clock, which never goes back.
class SerialDevice {
 public:
  SerialDevice() = default;
  SerialDevice(const SerialDevice&) = delete;
  SerialDevice& operator=(const SerialDevice&) = delete;
  SerialDevice(SerialDevice&&) = delete;
  SerialDevice& operator=(SerialDevice&&) = delete;
  virtual ~SerialDevice() = default;

  /// Bytes that the host wrote with its port set to `host`. A device with other settings
  /// understands none of them.
  virtual void receive(std::span<const std::uint8_t> bytes, const devices::LineSettings& host,
                       std::int64_t now_ns) = 0;
  /// Does everything that is due by now (measuring, reports, watchdog, restart).
  virtual void tick(std::int64_t now_ns) = 0;
  /// Latest time of the next `tick`.
  [[nodiscard]] virtual std::int64_t due_ns() const = 0;
  /// Bytes that have left the device's end of the line by now at its own rate, each byte once. If
  /// the host's port has other settings, it receives other bytes.
  [[nodiscard]] virtual std::vector<std::uint8_t> take_output(const devices::LineSettings& host,
                                                              std::int64_t now_ns) = 0;
};

}  // namespace topogeo::simulation
