// A serial port in a thread of its own: opens it again and again until it is there, reads, writes
// in order, and notices when it goes. Works with pseudo-terminals, too.
//
// Boost.Asio does the work: it is there already (the header-only part of Boost), supports 500,000
// baud and parity, reads and writes without blocking each other, and reports an unplugged adapter
// as an error of the pending read. libserialport, the other candidate, asks for modem lines when it
// opens a port, which a pseudo-terminal does not have.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::sensor_gateway {

/// Now, by the clock of all stamps of this folder: nanoseconds of the steady clock.
std::int64_t steady_now_ns();

struct PortOptions {
  std::string path;  ///< of the device, or a link to it, for example /dev/ttyUSB0
  /// Wait before a port that cannot be opened or was lost is tried again: doubled from try to try,
  /// up to the longest, and back to the first as soon as something was received.
  std::chrono::milliseconds first_wait{100};
  std::chrono::milliseconds longest_wait{5000};
};

/// What happened to a port.
struct PortEvent {
  enum class Kind { kOpened, kNotOpened, kLost, kBytes, kWritten };
  Kind kind{};
  std::int64_t stamp_ns = 0;
  std::uint64_t epoch = 0;  ///< see SerialPort::epoch
  std::string why;          ///< kNotOpened, kLost: one line naming the port
  std::vector<std::uint8_t> bytes;
  std::uint64_t orders = 0;  ///< kWritten: how many are carried out since the port was opened
};

class SerialPort {
 public:
  /// Starts the thread; `notify` is called in it. Throws std::invalid_argument when the path is
  /// empty or a wait is not positive. Everything else that can be wrong with a port comes as an
  /// event, as it may be right later.
  SerialPort(const PortOptions& options, std::function<void(PortEvent)> notify);
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  SerialPort(SerialPort&&) = delete;
  SerialPort& operator=(SerialPort&&) = delete;
  /// Closes the port. What was not written by then is not written.
  ~SerialPort();

  /// Carries the orders out one after the other, after those given before. They are for the port
  /// as it was opened in `epoch_opened` (of the event kOpened): if it was lost since, they are
  /// dropped.
  void write(std::vector<devices::LineOrder> orders, std::uint64_t epoch_opened);

  /// Counts the times that the port was opened or lost or its settings changed. Bytes of an
  /// earlier epoch than this are no longer wanted. For any thread.
  [[nodiscard]] std::uint64_t epoch() const;

  /// True as soon as all that was given to write() has left the port or is lost with it; false
  /// after `timeout`.
  [[nodiscard]] bool wait_written(std::chrono::milliseconds timeout);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace topogeo::sensor_gateway
