#include "device_config.hpp"

#include <charconv>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <vector>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"
#include "topogeo/devices/network_address.hpp"

#include "base_keys.hpp"

namespace topogeo::sensor_gateway {

using devices::Parity;
using devices::PlsOutput;
using support::ConfigSchema;
using Laser = DeviceFile::Laser;

namespace {

std::int64_t nanoseconds(double seconds) {
  return std::llround(seconds * 1e9);
}

double seconds(std::int64_t nanoseconds) {
  return static_cast<double>(nanoseconds) * 1e-9;
}

std::string join(const std::vector<std::uint32_t>& numbers) {
  std::string text;
  for (const std::uint32_t number : numbers) {
    if (!text.empty()) text += ' ';
    text += std::to_string(number);
  }
  return text;
}

std::vector<std::uint32_t> parse_bauds(const std::string& text) {
  std::vector<std::uint32_t> bauds;
  std::istringstream fields(text);
  for (std::string word; fields >> word;) {
    std::uint32_t baud = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), baud);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw std::invalid_argument("key 'laser.detection_bauds' = '" + text +
                                  "': expected baud rates separated by blanks");
    }
    bauds.push_back(baud);
  }
  return bauds;
}

void describe_laser_line(ConfigSchema& schema, Laser& laser) {
  schema.add("laser.port", &laser.port,
             "port of the laser: a serial port, for example /dev/ttyUSB0, or tcp://HOST:PORT of a "
             "laser on the network, udp://HOST:PORT of one that sends datagrams; empty: no laser");
  std::vector<std::pair<std::string, const devices::LaserModel*>> models;
  for (const devices::LaserModel& model : devices::laser_models()) {
    models.emplace_back(model.name, &model);
  }
  schema.add("laser.model", &laser.model, models,
             "what the laser is (docs/devices.md has the table). Keys from laser.baud to "
             "laser.sweep_to_send_s are for a sick_pls, except range_max_m and shortest_silence_s, "
             "which are for all");
  schema.add("laser.baud", &laser.settings.baud, 9600U, 500'000U, "baud",
             "working rate: 9600, 19200, 38400 or 500000, which needs an RS-422 line; a PLS gives "
             "1.2, 2.4, 4.8 or 25 scans a second with them");
  schema.add(
      "laser.kind", &laser.kind,
      {{"detect", Laser::Kind::kDetect}, {"pls", Laser::Kind::kPls}, {"lms", Laser::Kind::kLms}},
      "a PLS has even parity, an LMS none; a given kind is found twice as fast");
  schema.add("laser.output", &laser.settings.output,
             {{"continuous", PlsOutput::kContinuous}, {"on_request", PlsOutput::kOnRequest}},
             "continuous: the laser sends scan after scan; on_request: each scan is requested");
  schema.add("laser.password", &laser.settings.password_pls,
             "password of the installation mode of a PLS, eight characters; its owner may have "
             "changed it");
  schema.add("laser.password_lms", &laser.settings.password_lms, "the same for an LMS");
  schema.add("laser.power_on_baud", &laser.settings.power_on_baud, 9600U, 500'000U, "baud",
             "rate after the laser is switched on, unless its owner made another one permanent");
  schema.add("laser.detection_bauds", &laser.detection_bauds,
             "rates at which the laser is searched for, in this order");
}

void describe_laser_times(ConfigSchema& schema, Laser& laser) {
  schema.add("laser.ack_timeout_s", &laser.ack_timeout_s, 0.001, 10.0, "s",
             "time from a command to its acknowledgement; 0.04 s in one source");
  schema.add(
      "laser.reply_timeout_s", &laser.reply_timeout_s, 0.01, 60.0, "s",
      "time from the acknowledgement to the reply to a change of mode; sources wait 2.5 to 20 s");
  schema.add("laser.baud_reply_timeout_s", &laser.baud_reply_timeout_s, 0.01, 60.0, "s",
             "the same for a change of the rate, after which the line changes in any case");
  schema.add("laser.settle_s", &laser.settle_s, 0.001, 10.0, "s",
             "rest after a change of the rate; sources wait 0.25 to 5 s");
  schema.add("laser.byte_gap_s", &laser.byte_gap_s, 0.001, 1.0, "s",
             "silence within a telegram that ends it; longer for adapters that deliver in bursts");
  schema.add("laser.shortest_silence_s", &laser.shortest_silence_s, 0.1, 60.0, "s",
             "time without a scan, and at least four scan periods, after which the laser is "
             "searched for again");
  schema.add("laser.scan_period_s", &laser.scan_period_s, 0.005, 1.0, "s",
             "one turn of the mirror; 25 turns a second in one source");
  schema.add("laser.sweep_to_send_s", &laser.sweep_to_send_s, 0.0, 1.0, "s",
             "time from the middle of the sweep to the first byte of its telegram; it shifts all "
             "stamps, so measure it by turning the robot on the spot");
}

void describe_laser_scans(ConfigSchema& schema, Laser& laser) {
  schema.add("laser.range_max_m", &laser.settings.range_max_m, 1.0, 100.0, "m",
             "readings of this range or more are no return");
  schema.add("laser.first_no_return_code", &laser.first_no_return_code, 1U, 8192U, "",
             "the same for the number that the laser sends, whatever its unit; 8192: none");
  schema.add(
      "laser.dazzled_is_no_return", &laser.settings.dazzled_is_no_return,
      "true: a reading dazzled by glaring light is no return; false: it counts by its distance");
  schema.add("laser.drop_implausible", &laser.settings.drop_implausible,
             "drops scans that the laser itself reports as implausible");
  schema.add("laser.drop_at_error", &laser.settings.drop_at_error,
             "drops scans while the laser reports an error or a fatal error");
  schema.add("laser.stuck_scans", &laser.settings.stuck_scans, 0, 10'000, "",
             "identical scans are dropped from this many in a row on, because the laser hangs or "
             "is covered; 0: never");
  schema.add("laser.stuck_returns", &laser.stuck_returns, 0U, 2048U, "",
             "scans with fewer returns may repeat, because they show nothing");
}

void describe_turning_laser(ConfigSchema& schema, Laser& laser) {
  devices::TurningLaserSettings& s = laser.turning;
  schema.add("laser.line_baud", &s.baud, 0U, 3'000'000U, "baud",
             "rate of the line of a laser that turns all the way round; 0: that of the model");
  schema.add(
      "laser.beams", &laser.beams, 0U, 2048U, "",
      "beams of a scan of a laser that turns all the way round, to which all beams of a turn "
      "are mapped, or those that a SICK on the network is set to; 0: those of the model, otherwise "
      "at least 90");
  schema.add("laser.range_min_m", &s.range_min_m, 0.0, 100.0, "m",
             "shorter readings of such a laser are no return: the robot itself, for example");
  schema.add("laser.upside_down", &s.upside_down,
             "such a laser hangs upside down: its beams are mirrored");
  schema.add("laser.least_intensity", &laser.least_intensity, 0U, 255U, "",
             "readings of an LDROBOT laser with less intensity are no return; no document says "
             "which intensity is noise");
  schema.add("laser.packet_delay_s", &laser.packet_delay_s, 0.0, 1.0, "s",
             "time from the last beam of a packet to its first byte, which no document states; it "
             "shifts all stamps, so measure it by turning the robot on the spot");
}

void describe_lds(ConfigSchema& schema, Laser& laser) {
  schema.add("laser.checksum", &laser.lds.checksum,
             {{"model", devices::LdsChecksum::kModel},
              {"learn", devices::LdsChecksum::kLearn},
              {"drop", devices::LdsChecksum::kDrop},
              {"warn", devices::LdsChecksum::kWarn}},
             "packets of an lds01 or xv11 with a wrong checksum; model: an xv11 drops them, an "
             "lds01, whose rule is from one source, learns: drops them only after eight packets "
             "with the right one, and checks none if 64 have another");
}

void describe_scip(ConfigSchema& schema, Laser& laser) {
  devices::ScipSettings& s = laser.scip;
  schema.add(
      "laser.scip_scan", &s.kind,
      {{"md", devices::ScipScanKind::kThreeCharacters},
       {"ms", devices::ScipScanKind::kTwoCharacters},
       {"me", devices::ScipScanKind::kIntensities}},
      "scans of a Hokuyo; ms: two characters a reading, up to 4 m, for a slow line; me: with "
      "intensities, of UTM and UST");
  schema.add("laser.scip_least_intensity", &s.least_intensity, 0U, 262'143U, "",
             "readings of a Hokuyo with less intensity are no return, with scip_scan: me");
  schema.add("laser.scip_stamp", &s.stamp,
             {{"step_0", devices::ScipStamp::kStepZero}, {"rear", devices::ScipStamp::kRear}},
             "moment of a Hokuyo's time stamp; step_0: as the maker's document states; rear: when "
             "the beam points backwards, as the ROS driver assumes");
}

void describe_cola(ConfigSchema& schema, Laser& laser) {
  schema.add("laser.cola", &laser.cola.dialect,
             {{"detect", devices::ColaChoice::kDetect},
              {"a", devices::ColaChoice::kText},
              {"b", devices::ColaChoice::kBinary}},
             "telegrams of a SICK on the network; detect: CoLa A or B, whichever it answers");
  schema.add("laser.cola_zero_to_first_s", &laser.cola_zero_to_first_s, 0.0, 0.1, "s",
             "time from the zero index of a SICK, which a scan reports, to its first beam; no "
             "document states it, so measure it by turning the robot on the spot");
}

void describe_safety(ConfigSchema& schema, Laser& laser) {
  using devices::SafetyInterface;
  schema.add("laser.data_port", &laser.data_port, 0U, 65'535U, "",
             "UDP port of this computer to which a laser at udp://HOST sends its data; 0: any free "
             "one, so set it if a firewall has to let it pass");
  schema.add("laser.safety_channel", &laser.safety_channel, 0U, 3U, "",
             "data output of a SICK safety scanner that the gateway sets up for itself");
  schema.add("laser.safety_interface", &laser.safety.interface,
             {{"ethernet", SafetyInterface::kEthernet},
              {"efi_pro", SafetyInterface::kEfiPro},
              {"ethernet_ip", SafetyInterface::kEthernetIp},
              {"profinet", SafetyInterface::kProfinet}},
             "network interface of a SICK safety scanner, by its variant");
  schema.add(
      "laser.protective_path", &laser.protective_path, 0U, 20U, "",
      "cut-off path of a SICK safety scanner whose field stops the robot, as Safety Designer "
      "numbers it; 0: none");
  schema.add("laser.warning_path", &laser.warning_path, 0U, 20U, "",
             "cut-off path whose field slows the robot; 0: none");
}

/// The port of a laser on a network is that of its model, unless it is given.
std::string laser_port(const Laser& laser) {
  try {
    std::string port = devices::with_port(laser.port, laser.model->network_port);
    if (devices::is_network_address(port) && !devices::network_address(port).port) {
      throw std::invalid_argument("'" + port + "': expected a port after the host");
    }
    const bool datagrams = devices::sends_datagrams(*laser.model);
    if (devices::is_network_address(port) &&
        devices::network_address(port).datagrams != datagrams) {
      throw std::invalid_argument("'" + port + "': expected " + (datagrams ? "udp" : "tcp") +
                                  "://HOST of a " + std::string(laser.model->title));
    }
    return port;
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument("key 'laser.port' = " + std::string(error.what()));
  }
}

void describe_rplidar(ConfigSchema& schema, Laser& laser) {
  devices::RpLidarSettings& s = laser.rplidar;
  schema.add("laser.scan_mode", &s.scan,
             {{"model", devices::RpScan::kModel},
              {"standard", devices::RpScan::kStandard},
              {"express", devices::RpScan::kExpress}},
             "samples of an RPLIDAR; standard: without a checksum, of A1 and A2 with old firmware; "
             "express: in the mode laser.express_mode");
  schema.add(
      "laser.express_mode", &laser.express_mode, 0U, 15U, "",
      "working mode of the express scan; 0: that of all lasers. A mode with ultra packets is "
      "refused, one with dense packets works");
  schema.add("laser.motor", &s.motor,
             {{"model", devices::RpMotor::kModel},
              {"none", devices::RpMotor::kNone},
              {"dtr", devices::RpMotor::kDtr},
              {"pwm", devices::RpMotor::kPwm},
              {"speed", devices::RpMotor::kSpeed}},
             "how the motor of an RPLIDAR is started: by the signal DTR, a duty cycle, or a speed; "
             "model: by what the laser reports. The motor of a YDLIDAR: dtr, none, or as its model "
             "needs");
  schema.add("laser.motor_value", &laser.motor_value, 0U, 1500U, "",
             "duty cycle or turns a minute of that motor; 0: 660 or 600");
  schema.add("laser.compensation_signed", &s.compensation_signed,
             "the compensation of angles in express packets has a sign, as the maker's document "
             "states; the maker's own driver reads it without");
}

}  // namespace

DeviceFile::DeviceFile() {
  laser.model = &devices::laser_models().front();
  base.settings.model = &devices::base_models().front();
  const devices::PlsSettings& l = laser.settings;
  laser.detection_bauds = join(l.detection_bauds);
  laser.ack_timeout_s = seconds(l.ack_timeout_ns);
  laser.reply_timeout_s = seconds(l.reply_timeout_ns);
  laser.baud_reply_timeout_s = seconds(l.baud_reply_timeout_ns);
  laser.settle_s = seconds(l.settle_ns);
  laser.byte_gap_s = seconds(l.byte_gap_ns);
  laser.shortest_silence_s = seconds(l.shortest_silence_ns);
  laser.scan_period_s = seconds(l.scan_period_ns);
  laser.sweep_to_send_s = seconds(l.sweep_to_send_ns);
  laser.first_no_return_code = l.first_no_return_code;
  laser.stuck_returns = static_cast<std::uint32_t>(l.stuck_returns);
  laser.protective_path = laser.safety.protective_path;
  base.report_mask = base.settings.report_mask;
  base.error_delay_ticks = base.settings.error_delay_ticks;
  if (base.settings.torque) base.torque = *base.settings.torque;
}

ConfigSchema describe(DeviceFile& file) {
  ConfigSchema schema;
  describe_laser_line(schema, file.laser);
  describe_laser_scans(schema, file.laser);
  describe_laser_times(schema, file.laser);
  describe_turning_laser(schema, file.laser);
  describe_lds(schema, file.laser);
  describe_rplidar(schema, file.laser);
  describe_scip(schema, file.laser);
  describe_cola(schema, file.laser);
  describe_safety(schema, file.laser);
  describe_base(file.base, schema);
  schema.add(
      "body.sensors", &file.body,
      {{"none", BodySensorKind::kNone},
       {"b21", BodySensorKind::kB21},
       {"base", BodySensorKind::kBase}},
      "sonars, infrared and tactile sensors; base: the sonars that a pioneer reports; those of "
      "a real b21 cannot be read, because no source documents their bus (docs/devices.md)");
  schema.add("odometry.wait_s", &file.odometry_wait_s, 0.0, 1.0, "s",
             "longest time that a scan waits for the odometry after it; 0: the scan is published "
             "at once, with the last odometry extrapolated by its speeds");
  schema.add("odometry.longest_extrapolation_s", &file.longest_extrapolation_s, 0.0, 5.0, "s",
             "a scan later than this after the last odometry is dropped");
  return schema;
}

DeviceConfig to_config(const DeviceFile& file) {
  DeviceConfig config;
  config.laser_port = laser_port(file.laser);
  config.base_port = file.base.port;
  config.laser.model = file.laser.model;
  devices::PlsSettings& laser = config.laser.pls = file.laser.settings;
  laser.detection_bauds = parse_bauds(file.laser.detection_bauds);
  if (file.laser.kind == Laser::Kind::kPls) laser.parities = {Parity::kEven};
  if (file.laser.kind == Laser::Kind::kLms) laser.parities = {Parity::kNone};
  laser.ack_timeout_ns = nanoseconds(file.laser.ack_timeout_s);
  laser.reply_timeout_ns = nanoseconds(file.laser.reply_timeout_s);
  laser.baud_reply_timeout_ns = nanoseconds(file.laser.baud_reply_timeout_s);
  laser.settle_ns = nanoseconds(file.laser.settle_s);
  laser.byte_gap_ns = nanoseconds(file.laser.byte_gap_s);
  laser.shortest_silence_ns = nanoseconds(file.laser.shortest_silence_s);
  laser.scan_period_ns = nanoseconds(file.laser.scan_period_s);
  laser.sweep_to_send_ns = nanoseconds(file.laser.sweep_to_send_s);
  laser.first_no_return_code = static_cast<std::uint16_t>(file.laser.first_no_return_code);
  laser.stuck_returns = file.laser.stuck_returns;
  devices::TurningLaserSettings& turning = config.laser.turning = file.laser.turning;
  turning.beams = file.laser.beams;
  turning.least_intensity = static_cast<std::uint8_t>(file.laser.least_intensity);
  turning.packet_delay_ns = nanoseconds(file.laser.packet_delay_s);
  turning.range_max_m = laser.range_max_m;
  turning.silence_ns = laser.shortest_silence_ns;
  config.laser.lds = file.laser.lds;
  config.laser.rplidar = file.laser.rplidar;
  config.laser.scip = file.laser.scip;
  config.laser.cola = file.laser.cola;
  config.laser.cola.zero_to_first_ns = nanoseconds(file.laser.cola_zero_to_first_s);
  config.laser_data_port = static_cast<std::uint16_t>(file.laser.data_port);
  config.laser.safety = file.laser.safety;
  config.laser.safety.channel = static_cast<std::uint8_t>(file.laser.safety_channel);
  config.laser.safety.protective_path = static_cast<std::uint8_t>(file.laser.protective_path);
  config.laser.safety.warning_path = static_cast<std::uint8_t>(file.laser.warning_path);
  config.laser.rplidar.express_mode = static_cast<std::uint8_t>(file.laser.express_mode);
  config.laser.rplidar.motor_value = static_cast<std::uint16_t>(file.laser.motor_value);
  devices::BaseSettings& base = config.base = file.base.settings;
  base.line.baud = file.base.baud != 0 ? file.base.baud : base.model->baud;
  base.battery_low_v =
      file.base.battery_low_v != 0.0 ? file.base.battery_low_v : base.model->battery_low_v;
  base.report_mask = file.base.report_mask;
  base.error_delay_ticks = static_cast<std::uint16_t>(file.base.error_delay_ticks);
  base.torque.reset();
  if (file.base.torque >= 0) base.torque = static_cast<std::uint8_t>(file.base.torque);
  config.body_sensors = file.body;
  base.pioneer.sonars = file.body == BodySensorKind::kBase;
  config.odometry_wait_ns = nanoseconds(file.odometry_wait_s);
  config.longest_extrapolation_ns = nanoseconds(file.longest_extrapolation_s);
  static_cast<void>(devices::make_laser_driver(config.laser));  // checks the settings
  const auto driver = devices::make_base_driver(config.base);
  if (config.body_sensors == BodySensorKind::kBase &&
      (config.base_port.empty() || driver->sonars() == nullptr)) {
    throw std::invalid_argument(
        "key 'body.sensors' = 'base': expected a base.port and a base.model "
        "with sonars of its own");
  }
  check(base);
  if (config.laser_port.empty() && config.base_port.empty()) {
    throw std::invalid_argument(
        "keys 'laser.port' and 'base.port': expected at least one port, got none");
  }
  if (config.laser_port == config.base_port) {
    throw std::invalid_argument("key 'base.port' = '" + config.base_port +
                                "': expected another port than that of the laser");
  }
  return config;
}

DeviceConfig load_devices(const std::filesystem::path& path,
                          const std::optional<std::string>& laser_port,
                          const std::optional<std::string>& base_port) {
  DeviceFile file;
  support::load_yaml_file(path, describe(file));
  file.laser.port = laser_port.value_or(file.laser.port);
  file.base.port = base_port.value_or(file.base.port);
  try {
    return to_config(file);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path.string() + ": " + error.what());
  }
}

}  // namespace topogeo::sensor_gateway
