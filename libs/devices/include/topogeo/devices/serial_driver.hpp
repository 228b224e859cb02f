// Interface between the driver of a serial device and the owner of its port. A driver does no input
// or output and has no clock: the owner passes it bytes and the time, and carries out its orders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

enum class Parity { kNone, kEven, kOdd };

/// Always eight data bits, one stop bit, no flow control.
struct LineSettings {
  std::uint32_t baud = 9600;
  Parity parity = Parity::kNone;
  bool operator==(const LineSettings&) const = default;
};

/// One action on the line. Orders are carried out in succession. Settings take effect after
/// everything written before has left the port, and before `bytes` are written. A change of
/// settings drops received bytes that the driver has not got yet. `dtr` sets or clears the signal
/// DTR before the bytes; a port without the signal ignores it.
struct LineOrder {
  std::optional<LineSettings> settings{};
  std::vector<std::uint8_t> bytes{};
  std::optional<bool> dtr{};
};

/// Times are nanoseconds of one steady clock that never goes back.
class SerialDriver {
 public:
  SerialDriver() = default;
  SerialDriver(const SerialDriver&) = delete;
  SerialDriver& operator=(const SerialDriver&) = delete;
  SerialDriver(SerialDriver&&) = delete;
  SerialDriver& operator=(SerialDriver&&) = delete;
  virtual ~SerialDriver() = default;

  /// The port is open, for the first time or again: the driver starts the device up from scratch.
  virtual void opened(std::int64_t now_ns) = 0;
  /// The port is gone (unplugged, closed). The driver gives no orders until `opened`.
  virtual void lost(std::int64_t now_ns) = 0;
  /// Bytes received over the line, in order, cut anywhere.
  virtual void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// Does everything that is due by now (time-outs, repeated commands).
  virtual void tick(std::int64_t now_ns) = 0;
  /// Latest time of the next `tick`; the largest number if nothing is awaited.
  [[nodiscard]] virtual std::int64_t due_ns() const = 0;
  /// Actions for the line, in order; each order is given once.
  [[nodiscard]] virtual std::vector<LineOrder> take_orders() = 0;
  /// All orders that were taken so far have been written to the line.
  virtual void written(std::int64_t now_ns) { static_cast<void>(now_ns); }
};

}  // namespace topogeo::devices
