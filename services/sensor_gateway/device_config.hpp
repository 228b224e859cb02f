// The devices of a robot: their ports and protocols.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/laser_settings.hpp"
#include "topogeo/support/config_schema.hpp"

namespace topogeo::sensor_gateway {

/// Sonars, infrared and tactile sensors: of a B21, or the sonars that the base reports.
enum class BodySensorKind : std::uint8_t { kNone, kB21, kBase };

/// Same structure as the file; a device without a port does not exist.
struct DeviceFile {
  struct Laser {
    std::string port;
    const devices::LaserModel* model = nullptr;  ///< set by the constructor
    devices::PlsSettings settings;
    devices::TurningLaserSettings turning;
    devices::LdsSettings lds;
    devices::RpLidarSettings rplidar;
    devices::ScipSettings scip;
    devices::ColaSettings cola;
    double cola_zero_to_first_s = 0.0;  ///< as nanoseconds in `cola`
    devices::SafetySettings safety;
    std::uint32_t safety_channel = 0;  ///< this and the paths: as in `safety`
    std::uint32_t protective_path = 0;
    std::uint32_t warning_path = 0;
    std::uint32_t data_port = 0;        ///< as DeviceConfig::laser_data_port
    std::uint32_t express_mode = 0;     ///< as `rplidar.express_mode`
    std::uint32_t motor_value = 0;      ///< as `rplidar.motor_value`
    std::uint32_t beams = 0;            ///< as `turning.beams`
    std::uint32_t least_intensity = 0;  ///< as `turning.least_intensity`
    double packet_delay_s = 0.0;        ///< as nanoseconds in `turning`
    std::string detection_bauds;        ///< numbers separated by blanks
    enum class Kind { kDetect, kPls, kLms } kind = Kind::kDetect;
    double ack_timeout_s = 0.0;  ///< this and the following: as nanoseconds in `settings`
    double reply_timeout_s = 0.0;
    double baud_reply_timeout_s = 0.0;
    double settle_s = 0.0;
    double byte_gap_s = 0.0;
    double shortest_silence_s = 0.0;
    double scan_period_s = 0.0;
    double sweep_to_send_s = 0.0;
    std::uint32_t first_no_return_code = 0;
    std::uint32_t stuck_returns = 0;
  } laser;
  struct Base {
    std::string port;
    devices::BaseSettings settings;
    std::uint32_t baud = 0;      ///< 0: that of the model
    double battery_low_v = 0.0;  ///< 0: that of the model
    std::uint32_t report_mask = 0;
    std::uint32_t error_delay_ticks = 0;
    std::int32_t torque = -1;  ///< negative: left unchanged
  } base;
  BodySensorKind body = BodySensorKind::kNone;
  double odometry_wait_s = 0.0;
  double longest_extrapolation_s = 0.5;

  DeviceFile();
};

/// Declares every key with its variable in `file`, its range, unit and reason.
support::ConfigSchema describe(DeviceFile& file);

/// Configuration that the gateway uses.
struct DeviceConfig {
  std::string laser_port;             ///< empty: no laser
  std::uint16_t laser_data_port = 0;  ///< see PortOptions::data_port
  devices::LaserSettings laser;
  std::string base_port;  ///< empty: no base
  devices::BaseSettings base;
  BodySensorKind body_sensors = BodySensorKind::kNone;
  std::int64_t odometry_wait_ns = 0;
  std::int64_t longest_extrapolation_ns = 0;
};

/// Throws std::invalid_argument naming the key whose value is wrong.
DeviceConfig to_config(const DeviceFile& file);

/// The devices of a file, optionally at other ports. Throws std::runtime_error naming the file, and
/// line and key where possible.
DeviceConfig load_devices(const std::filesystem::path& path,
                          const std::optional<std::string>& laser_port = {},
                          const std::optional<std::string>& base_port = {});

}  // namespace topogeo::sensor_gateway
