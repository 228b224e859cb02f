// The robot's base: its line, odometry and state, and the commands to it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "topogeo/devices/base_driver.hpp"
#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/motion.h"
#include "topogeo/msg/sensor.h"
#include "topogeo/navigation/last_guard.hpp"
#include "topogeo/service/command_ages.hpp"
#include "topogeo/service/service.hpp"

#include "device_config.hpp"
#include "host_time.hpp"
#include "odometry_memory.hpp"
#include "serial_line.hpp"
#include "stop_count.hpp"
#include "stop_memory.hpp"

namespace topogeo::sensor_gateway {

/// Lives in the loop of its service.
class BaseChannel {
 public:
  /// `on_epoch` gets the epoch of the odometry before `on_odometry` gets the first sample; samples
  /// are stamped by the steady clock. With a `remembered` state the odometry continues in its
  /// epoch, if the base has kept counting.
  struct Hooks {
    std::function<void(std::uint64_t epoch, bool resumed)> on_epoch;
    std::function<void(const geometry::OdometrySample&)> on_odometry;
  };
  /// Halt and emergency stop are kept in the file `stop_memory`.
  BaseChannel(service::Service& service, const DeviceConfig& config, const HostTime& time,
              const std::optional<RememberedOdometry>& remembered,
              const std::filesystem::path& stop_memory, Hooks hooks);
  BaseChannel(const BaseChannel&) = delete;
  BaseChannel& operator=(const BaseChannel&) = delete;
  BaseChannel(BaseChannel&&) = delete;
  BaseChannel& operator=(BaseChannel&&) = delete;
  /// Stops the base, unless stop() has done so.
  ~BaseChannel();

  /// Takes the laser's view, stamped by the steady clock: the base stops before obstacles, whatever
  /// is commanded.
  void see(const navigation::ScanPoints& scan);

  /// Whether the base takes motion commands.
  [[nodiscard]] bool ready() const { return driver_->status().commands_taken; }
  /// For people: "ready", or the state and the reason.
  [[nodiscard]] std::string describe() const;
  /// Sets the counters of the service's status.
  void count();
  /// Empty until the first odometry.
  [[nodiscard]] std::optional<devices::OdometerState> odometer_state() const {
    return driver_->odometer_state();
  }

  /// Null: the base has none. They live as long as this object.
  [[nodiscard]] devices::BodySensors* sonars() { return driver_->sonars(); }
  [[nodiscard]] std::vector<devices::SonarMount> sonar_mounts() const {
    return driver_->sonar_mounts();
  }

  [[nodiscard]] messaging::Writer<msg::Odometry>& odometry() { return odometry_; }

  /// Stops the base for good and waits until it stands, at most half a second. The base's own
  /// watchdog stops it if this command does not arrive. A halt or a reset that comes later is
  /// stored for the next gateway.
  void stop();

 private:
  void after_driver(std::int64_t now_ns);
  /// The stops that an earlier gateway has left hold on.
  void resume_stops();
  /// Decides whether the odometry continues or begins a new epoch.
  void begin_epoch(std::int64_t stamp_ns);
  void on_command(const msg::MotionCommand& command, const messaging::SampleInfo& info);
  /// The age of a command; nothing, with a drop counted, when it is too old or unknown.
  std::optional<std::int64_t> age_of(const msg::MotionCommand& command,
                                     const messaging::SampleInfo& info, std::int64_t now_ns);
  [[nodiscard]] devices::BaseVelocity guarded(const devices::BaseVelocity& wanted,
                                              std::int64_t now_ns);
  /// The part of a velocity that the base can drive; counts turns that are too tight for it.
  [[nodiscard]] geometry::Velocity drivable(const geometry::Velocity& asked);
  void on_command(const msg::BaseCommand& command, const messaging::SampleInfo& info);
  void reset_stop(const msg::BaseCommand& command, const messaging::Handle& writer,
                  std::int64_t now_ns);
  /// A change of it is published at once.
  struct Shown {
    devices::BaseState state = devices::BaseState::kOffline;
    bool ready = false;
    bool stands = false;
    std::uint64_t stop_count = 0;

    friend bool operator==(const Shown&, const Shown&) = default;
  };
  [[nodiscard]] Shown shown() const {
    return {driver_->status().state, ready(), driver_->status().stands, stop_count_.number()};
  }
  void publish_status();

  service::Service& service_;
  const HostTime& time_;
  std::optional<RememberedOdometry> remembered_;
  Hooks hooks_;
  std::optional<std::uint64_t> odometry_epoch_;
  std::unique_ptr<devices::BaseDriver> driver_;
  StopMemory stop_memory_;
  StopCount stop_count_;
  std::optional<navigation::LastGuard> guard_;  ///< only with a laser
  navigation::LastGuard::Verdict verdict_ = navigation::LastGuard::Verdict::kAsWanted;
  std::uint64_t guard_stops_ = 0;
  double minimum_radius_m_;  ///< 0: the base turns on the spot
  bool too_tight_ = false;   ///< the last command turned too tightly
  std::uint64_t tight_turns_ = 0;
  service::CommandAges ages_;
  messaging::Writer<msg::Odometry> odometry_;
  messaging::Writer<msg::BaseStatus> statuses_;
  std::uint64_t odometry_sent_ = 0;
  std::uint64_t statuses_sent_ = 0;
  std::uint64_t commands_ = 0;
  std::uint64_t refused_ = 0;
  Shown published_;
  bool stopped_ = false;
  std::uint64_t timer_ = 0;
  SerialLine line_;
};

}  // namespace topogeo::sensor_gateway
