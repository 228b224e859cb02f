// A port of a device in a thread of its own: retries until it opens, reads, writes in order, and
// detects its loss. It is a serial port or, in its place, a network connection (port_stream.hpp).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/devices/serial_driver.hpp"

namespace topogeo::sensor_gateway {

struct PortOptions {
  std::string path;  ///< a device or a link to it, for example /dev/ttyUSB0; or tcp://HOST:PORT
  /// Wait before retrying a port that cannot be opened or was lost: doubled from try to try, up to
  /// the longest, and reset as soon as something is received.
  std::chrono::milliseconds first_wait{100};
  std::chrono::milliseconds longest_wait{5000};
  /// If not empty, a StopSentry writes them when the program is killed, or writes nothing for
  /// `stop_after`.
  std::vector<std::uint8_t> stop_bytes{};
  std::chrono::milliseconds stop_after{};
  /// This host's port for the datagrams of a path udp://HOST:PORT; 0: any free one.
  std::uint16_t data_port = 0;
};

/// An event of a port.
struct PortEvent {
  enum class Kind { kOpened, kNotOpened, kLost, kBytes, kWritten };
  Kind kind{};
  std::int64_t stamp_ns = 0;
  std::uint64_t epoch = 0;  ///< see SerialPort::epoch
  std::string why;          ///< kNotOpened, kLost: one line naming the port
  std::vector<std::uint8_t> bytes;
  std::uint64_t orders = 0;  ///< kWritten: number carried out since the port was opened
};

class SerialPort {
 public:
  /// Starts the thread; `notify` is called in it. Throws std::invalid_argument when the path is
  /// empty or no address, or a wait is not positive. Every other problem of a port comes as an
  /// event, because it may pass.
  SerialPort(const PortOptions& options, std::function<void(PortEvent)> notify);
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;
  SerialPort(SerialPort&&) = delete;
  SerialPort& operator=(SerialPort&&) = delete;
  /// Closes the port. Unwritten orders are dropped.
  ~SerialPort();

  /// Carries the orders out in turn, after the earlier ones. They are meant for the port as opened
  /// in `epoch_opened` (from the event kOpened): if it was lost since, they are dropped.
  void write(std::vector<devices::LineOrder> orders, std::uint64_t epoch_opened);

  /// Counts how often the port was opened or lost or changed its settings. Bytes of an earlier
  /// epoch are not wanted any more. Thread-safe.
  [[nodiscard]] std::uint64_t epoch() const;

  /// True as soon as everything given to write() has left the port or is lost with it; false after
  /// `timeout`.
  [[nodiscard]] bool wait_written(std::chrono::milliseconds timeout);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace topogeo::sensor_gateway
