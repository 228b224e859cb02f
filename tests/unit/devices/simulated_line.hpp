// A driver and an emulated device at the two ends of a serial line, on a clock of their own: time
// jumps to the next due event, so that hours of faults pass in seconds, always in the same way.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/serial_driver.hpp"
#include "topogeo/simulation/serial_device.hpp"

namespace topogeo::devices {

class SimulatedLine {
 public:
  /// Period in which a port collects bytes before it delivers them, like an adapter.
  static constexpr std::int64_t kReadPeriod_ns = 1'000'000;

  SimulatedLine(SerialDriver& driver, simulation::SerialDevice& device, std::int64_t start_ns = 0)
      : driver_(driver), device_(device), now_ns_(start_ns), read_due_ns_(start_ns) {}

  [[nodiscard]] std::int64_t now_ns() const { return now_ns_; }
  [[nodiscard]] const LineSettings& host() const { return host_; }
  [[nodiscard]] bool plugged() const { return plugged_; }

  /// Changes bytes from the device to the driver: line noise, for example.
  void set_filter(std::function<void(std::vector<std::uint8_t>&)> filter) {
    filter_ = std::move(filter);
  }

  /// Changes bytes from the driver to the device.
  void set_host_filter(std::function<void(std::vector<std::uint8_t>&)> filter) {
    host_filter_ = std::move(filter);
  }

  /// Whether the line echoes the driver's bytes, like some two-wire adapters.
  void set_echo(bool echo) { echo_ = echo; }

  /// The port appears, with arbitrary settings.
  void plug_in() {
    if (plugged_) return;
    plugged_ = true;
    host_ = {};
    (void)device_.take_output(host_, now_ns_);
    driver_.opened(now_ns_);
    settle();
  }

  /// The port disappears with all bytes in transit. The device keeps running.
  void unplug() {
    if (!plugged_) return;
    plugged_ = false;
    orders_.clear();
    written_ns_.reset();
    driver_.lost(now_ns_);
    settle();
  }

  /// The driver's process is frozen: it gets no time and no bytes. Written bytes are sent, and
  /// received ones wait in the port.
  void freeze_host(bool frozen) { frozen_ = frozen; }

  /// Nothing is written, though the driver has time and reads received bytes: the thread of the
  /// port waits for a CPU.
  void hold_orders(bool held) { held_ = held; }

  /// Lets `duration_ns` pass.
  void run_for(std::int64_t duration_ns) {
    run_until(duration_ns, [] { return false; });
  }

  /// Passes time until `done` holds, which is checked after every step, or `limit_ns` are over.
  /// Returns whether it holds.
  template <typename Done>
  bool run_until(std::int64_t limit_ns, const Done& done) {
    const std::int64_t end_ns = now_ns_ + limit_ns;
    settle();
    while (!done()) {
      if (now_ns_ >= end_ns) return false;
      step(end_ns);
    }
    return true;
  }

 private:
  void step(std::int64_t end_ns) {
    std::int64_t next_ns = std::min({end_ns, read_due_ns_, device_.due_ns()});
    if (plugged_ && !frozen_) next_ns = std::min(next_ns, driver_.due_ns());
    if (written_ns_ && !held_) next_ns = std::min(next_ns, *written_ns_);
    now_ns_ = std::max(next_ns, now_ns_ + 1);
    if (device_.due_ns() <= now_ns_) device_.tick(now_ns_);
    if (now_ns_ >= read_due_ns_) {
      read_due_ns_ = now_ns_ + kReadPeriod_ns;
      read();
    }
    if (plugged_ && !frozen_ && driver_.due_ns() <= now_ns_) driver_.tick(now_ns_);
    settle();
  }

  void read() {
    if (frozen_) return;
    std::vector<std::uint8_t> bytes = device_.take_output(host_, now_ns_);
    if (!plugged_) return;
    if (filter_) filter_(bytes);
    if (!bytes.empty()) driver_.receive(bytes, now_ns_);
  }

  void take_orders() {
    for (LineOrder& order : driver_.take_orders()) {
      if (plugged_) orders_.push_back(std::move(order));
    }
  }

  /// Takes the driver's orders and executes those that are possible by now.
  void settle() {
    if (!frozen_) take_orders();
    while (!orders_.empty() && !held_) {
      LineOrder& order = orders_.front();
      if (!written_ns_) {
        if (order.settings && *order.settings != host_) {
          (void)device_.take_output(host_, now_ns_);
          host_ = *order.settings;
        }
        written_ns_ = now_ns_ + line_time_ns(order.bytes.size(), host_);
      }
      if (*written_ns_ > now_ns_) return;
      written_ns_.reset();
      std::vector<std::uint8_t> bytes = std::move(order.bytes);
      orders_.pop_front();
      if (!bytes.empty()) {
        if (echo_) driver_.receive(bytes, now_ns_);
        if (host_filter_) host_filter_(bytes);
        device_.receive(bytes, host_, now_ns_);
      }
      if (orders_.empty()) unconfirmed_ = true;
    }
    // A frozen driver is notified later.
    if (!frozen_ && orders_.empty() && std::exchange(unconfirmed_, false)) driver_.written(now_ns_);
  }

  SerialDriver& driver_;
  simulation::SerialDevice& device_;
  std::function<void(std::vector<std::uint8_t>&)> filter_;
  std::function<void(std::vector<std::uint8_t>&)> host_filter_;
  bool echo_ = false;
  std::int64_t now_ns_;
  std::int64_t read_due_ns_;
  bool plugged_ = false;
  bool frozen_ = false;
  bool held_ = false;
  bool unconfirmed_ = false;  ///< the driver does not know yet that all its orders were written
  LineSettings host_;
  std::deque<LineOrder> orders_;
  std::optional<std::int64_t> written_ns_;  ///< when the bytes of the first order were sent
};

}  // namespace topogeo::devices
