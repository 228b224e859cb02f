// The interface between the driver of a serial device and the owner of its port. A driver
// does no input or output and has no clock: whoever owns the port hands it bytes and the time, and
// carries out what it orders.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace topogeo::devices {

enum class Parity { kNone, kEven, kOdd };

/// Eight data bits, one stop bit, no flow control, and:
struct LineSettings {
  std::uint32_t baud = 9600;
  Parity parity = Parity::kNone;
  bool operator==(const LineSettings&) const = default;
};

/// One thing to do with the line. Orders are carried out in succession; settings take effect when
/// everything written before has left the port, and before `bytes` are written. What was received
/// and not yet handed on by then is dropped with a change of settings.
struct LineOrder {
  std::optional<LineSettings> settings{};
  std::vector<std::uint8_t> bytes{};
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

  /// The port is open, for the first time or again: the driver starts the device up from nothing.
  virtual void opened(std::int64_t now_ns) = 0;
  /// The port is gone (unplugged, closed). Until `opened` the driver orders nothing.
  virtual void lost(std::int64_t now_ns) = 0;
  /// Bytes that came over the line, in their order, cut anywhere.
  virtual void receive(std::span<const std::uint8_t> bytes, std::int64_t now_ns) = 0;
  /// Does what is due by now (time-outs, repeated commands).
  virtual void tick(std::int64_t now_ns) = 0;
  /// When `tick` is to be called at the latest; the largest number while nothing is awaited.
  [[nodiscard]] virtual std::int64_t due_ns() const = 0;
  /// What is to be done with the line, in order; each order is given once.
  [[nodiscard]] virtual std::vector<LineOrder> take_orders() = 0;
  /// All orders that were taken so far have been written to the line.
  virtual void written(std::int64_t now_ns) { static_cast<void>(now_ns); }
};

}  // namespace topogeo::devices
