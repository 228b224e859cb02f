// Connects a driver to its device: a port, the driver and the event loop of a service.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/messaging/event_loop.hpp"

#include "serial_port.hpp"

namespace topogeo::sensor_gateway {

struct LineStatistics {
  std::uint64_t opened = 0;      ///< times the port was opened
  std::uint64_t lost = 0;        ///< times it was lost
  std::uint64_t not_opened = 0;  ///< failed attempts
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_stale = 0;  ///< dropped, because they came before a change of settings
};

/// Lives in the thread of its loop, as does the driver.
class SerialLine {
 public:
  /// Called after each input to the driver, so that the caller can fetch its results; `now_ns`
  /// never goes back.
  using AfterHandler = std::function<void(std::int64_t now_ns)>;

  /// The driver must outlive the line. Throws like SerialPort.
  SerialLine(messaging::EventLoop& loop, devices::SerialDriver& driver, const PortOptions& options,
             AfterHandler after);
  SerialLine(const SerialLine&) = delete;
  SerialLine& operator=(const SerialLine&) = delete;
  SerialLine(SerialLine&&) = delete;
  SerialLine& operator=(SerialLine&&) = delete;
  ~SerialLine();

  [[nodiscard]] bool is_open() const { return open_; }
  /// Why the port is not open, one line naming it; empty when it is open or not yet tried.
  [[nodiscard]] const std::string& why_closed() const { return why_closed_; }
  [[nodiscard]] const LineStatistics& statistics() const { return statistics_; }

  /// Carries out the driver's orders. Call it after every call of the driver that this line did not
  /// make.
  void carry_out();

  /// True as soon as all orders are carried out or lost with the port; false after `timeout`.
  [[nodiscard]] bool wait_written(std::chrono::milliseconds timeout) {
    return port_->wait_written(timeout);
  }

  /// The current time, never before an earlier result or the stamp of a byte given to the driver.
  [[nodiscard]] std::int64_t now_ns();

 private:
  void on_event(const PortEvent& event);
  void after(std::int64_t now_ns);
  void tick();
  void arm();

  messaging::EventLoop& loop_;
  devices::SerialDriver& driver_;
  AfterHandler after_;
  bool open_ = false;
  std::string why_closed_;
  std::uint64_t epoch_opened_ = 0;
  std::uint64_t given_ = 0;  // number of orders since the port was opened
  std::int64_t last_ns_ = 0;
  LineStatistics statistics_;
  std::uint64_t timer_ = 0;
  std::int64_t timer_due_ns_ = 0;
  bool timer_armed_ = false;
  bool deferred_ = false;              // a late timer waits for bytes to be read
  std::shared_ptr<SerialLine*> self_;  // events of the port may arrive after the end
  std::unique_ptr<SerialPort> port_;
};

}  // namespace topogeo::sensor_gateway
