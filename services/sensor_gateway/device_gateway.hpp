// Publishes the scans, odometry and states of real devices, and drives the base.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/devices/body_sensors.hpp"
#include "topogeo/matching/laser_odometry.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"
#include "topogeo/service/body_sensor_publisher.hpp"
#include "topogeo/service/service.hpp"

#include "base_channel.hpp"
#include "device_config.hpp"
#include "host_time.hpp"
#include "laser_channel.hpp"
#include "odometry_memory.hpp"
#include "reader_wait.hpp"
#include "scan_gate.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the loop of its service.
class DeviceGateway {
 public:
  /// Scans are numbered and published once `readers` programs that read them are connected. The
  /// file `memory` (empty: none) keeps the state of odometry and numbers across restarts, and
  /// MEMORY.laser the baud rate of the laser.
  DeviceGateway(service::Service& service, const DeviceConfig& config, int readers,
                const std::filesystem::path& memory = {});
  DeviceGateway(const DeviceGateway&) = delete;
  DeviceGateway& operator=(const DeviceGateway&) = delete;
  DeviceGateway(DeviceGateway&&) = delete;
  DeviceGateway& operator=(DeviceGateway&&) = delete;
  ~DeviceGateway();

  /// Call it after the loop: stops the base, waits until the readers have all published data and
  /// announces the end of the stream. Runs the loop meanwhile, so that the base's halt and reset
  /// are stored for the next gateway.
  void finish();

 private:
  void remember();
  /// Begins odometry from the scans, unless the configuration wants none.
  void begin_without_base();
  /// Reports a fault if the base runs on for longer than the guards assume.
  void compare_watchdog(double watchdog_s);
  /// Shows the laser's view to the base at once, which stops before obstacles.
  void show_base(const devices::LaserScan& scan);
  /// Publishes the scans that are ready, until finish().
  void release(std::int64_t now_ns);
  /// The scan with its odometry, or those that odometry from the scans has placed by now.
  std::vector<scan::Scan> placed(scan::Scan scan);
  /// False, with a fault, when the scan cannot be sent.
  bool publish(const scan::Scan& scan);
  void publish_state();
  void begin_body(BodySensorKind kind);
  void read_body();
  /// Runs the loop until the readers have all data of the writer; false after `timeout`.
  template <class T>
  [[nodiscard]] bool deliver(messaging::Writer<T>& writer, std::chrono::nanoseconds timeout);

  service::Service& service_;
  HostTime time_;
  OdometryMemory memory_;
  std::uint64_t odometry_epoch_;
  ScanGate gate_;
  messaging::Writer<msg::Scan> scans_;
  messaging::Writer<msg::StreamEnd> stream_end_;
  std::int64_t last_stamp_ns_ = 0;
  std::uint64_t sent_ = 0;
  std::optional<localization::LaserOdometry> laser_odometry_;  // without a base
  std::uint64_t breaks_ = 0;                                   // of its track, reported so far
  std::uint64_t numbered_ = 0;                                 // scans for publication
  bool ended_ = false;                                         // by finish()
  // Time between reading the last bytes of a scan from the port and publishing it.
  std::int64_t latency_ns_ = 0;          // of the last scan
  std::int64_t largest_latency_ns_ = 0;  // of all scans
  std::int64_t wait_ns_ = 0;             // part of latency_ns_ spent waiting for odometry
  std::string published_;                // last state of the service
  std::uint64_t timer_ = 0;              // of publish_state
  std::uint64_t release_timer_ = 0;      // runs while scans wait for odometry
  std::uint64_t body_timer_ = 0;         // of read_body
  std::unique_ptr<devices::BodySensors> body_sensors_;
  std::optional<BaseChannel> base_;
  std::optional<service::BodySensorPublisher> body_;  // may read the base
  std::optional<LaserChannel> laser_;
  std::optional<ReaderWait> reader_wait_;
};

}  // namespace topogeo::sensor_gateway
