// The base of the robot: its line, its odometry, its state, and the commands to it.
#pragma once

#include <cstdint>
#include <functional>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/service/service.hpp"

#include "device_config.hpp"
#include "host_time.hpp"
#include "serial_line.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the loop of its service.
class BaseChannel {
 public:
  /// `on_odometry` gets every sample, stamped by the steady clock.
  BaseChannel(service::Service& service, const DeviceConfig& config, const HostTime& time,
              std::uint64_t odometry_epoch,
              std::function<void(const geometry::OdometrySample&)> on_odometry);
  BaseChannel(const BaseChannel&) = delete;
  BaseChannel& operator=(const BaseChannel&) = delete;
  BaseChannel(BaseChannel&&) = delete;
  BaseChannel& operator=(BaseChannel&&) = delete;
  /// Halts the base, unless stop() has done it.
  ~BaseChannel();

  /// Whether it takes motion commands.
  [[nodiscard]] bool ready() const { return driver_.status().commands_taken; }
  /// For people: "ready", or the state and why.
  [[nodiscard]] std::string describe() const;
  /// Sets the counters of the service's status.
  void count();

  /// Halts the base and waits, at most half a second, until it stands. Its own watchdog stops it
  /// if this does not reach it.
  void stop();

 private:
  void after_driver(std::int64_t now_ns);
  void on_command(const msg::MotionCommand& command);
  void on_command(const msg::BaseCommand& command);
  void publish_status();

  service::Service& service_;
  const HostTime& time_;
  const std::uint64_t odometry_epoch_;
  std::function<void(const geometry::OdometrySample&)> on_odometry_;
  devices::BaseDriver driver_;
  messaging::Writer<msg::Odometry> odometry_;
  messaging::Writer<msg::BaseStatus> statuses_;
  std::uint64_t odometry_sent_ = 0;
  std::uint64_t statuses_sent_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t refused_ = 0;
  devices::BaseState published_state_ = devices::BaseState::kOffline;
  bool published_ready_ = false;
  bool stopped_ = false;
  std::uint64_t timer_ = 0;
  SerialLine line_;
};

}  // namespace topogeo::sensor_gateway
