// The robot's laser: its line, scans and state.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "topogeo/devices/laser_driver.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/service/service.hpp"

#include "device_config.hpp"
#include "host_time.hpp"
#include "laser_memory.hpp"
#include "scan_gate.hpp"
#include "serial_line.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the loop of its service.
class LaserChannel {
 public:
  /// `on_scan` gets each scan on arrival, as does `gate`; then `on_scans` is called. The file
  /// `memory` (empty: none) keeps the baud rate of the laser.
  LaserChannel(service::Service& service, const DeviceConfig& config, const HostTime& time,
               ScanGate& gate, const std::filesystem::path& memory,
               std::function<void(const devices::LaserScan&)> on_scan,
               std::function<void(std::int64_t now_ns)> on_scans);
  LaserChannel(const LaserChannel&) = delete;
  LaserChannel& operator=(const LaserChannel&) = delete;
  LaserChannel(LaserChannel&&) = delete;
  LaserChannel& operator=(LaserChannel&&) = delete;
  ~LaserChannel();

  /// Call it after the loop: stops a laser that can be stopped.
  void finish();

  [[nodiscard]] bool running() const;
  /// For people: "running", or the state and the reason.
  [[nodiscard]] std::string describe() const;
  /// Sets the counters of the service's status.
  void count();

 private:
  void after_driver(std::int64_t now_ns);
  void publish_status();
  [[nodiscard]] msg::LaserState state(const devices::LaserHealth& health) const;
  /// Why the state is what it is; of a running laser, why its rate is not the wanted one.
  [[nodiscard]] std::string reason(const devices::LaserHealth& health) const;
  /// Why the scans of a running laser are of no use; empty: they are usable.
  [[nodiscard]] std::string fault(const devices::LaserHealth& health) const;

  service::Service& service_;
  const HostTime& time_;
  ScanGate& gate_;
  LaserMemory memory_;
  std::function<void(const devices::LaserScan&)> on_scan_;
  std::function<void(std::int64_t)> on_scans_;
  std::unique_ptr<devices::LaserDriver> driver_;
  messaging::Writer<msg::LaserStatus> statuses_;
  std::uint64_t statuses_sent_ = 0;
  msg::LaserState published_state_ = msg::kLaserOffline;
  std::uint32_t beams_ = 0;
  std::uint32_t dazzled_ = 0;
  bool warning_field_ = false;
  bool protective_field_ = false;
  bool published_warning_ = false;
  bool published_protective_ = false;
  std::deque<std::int64_t> recent_ns_;  // arrival times of recent scans
  std::uint64_t timer_ = 0;
  SerialLine line_;
};

}  // namespace topogeo::sensor_gateway
