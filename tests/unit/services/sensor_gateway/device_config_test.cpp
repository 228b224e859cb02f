#include "sensor_gateway/device_config.hpp"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/devices/base_models.hpp"
#include "topogeo/devices/laser_models.hpp"

namespace topogeo::sensor_gateway {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

DeviceConfig config_of(const std::string& text) {
  DeviceFile file;
  support::load_yaml_text(text, "devices.yaml", describe(file));
  return to_config(file);
}

TEST(DeviceConfig, DefaultsAreThoseOfTheDrivers) {
  const DeviceConfig config = config_of("laser.port: /dev/a\nbase.port: /dev/b\n");
  const devices::PlsSettings laser;
  EXPECT_EQ(config.laser_port, "/dev/a");
  EXPECT_EQ(config.laser.pls.baud, laser.baud);
  EXPECT_EQ(config.laser.pls.detection_bauds, laser.detection_bauds);
  EXPECT_EQ(config.laser.pls.parities, laser.parities);
  EXPECT_EQ(config.laser.pls.ack_timeout_ns, laser.ack_timeout_ns);
  EXPECT_EQ(config.laser.pls.sweep_to_send_ns, laser.sweep_to_send_ns);
  EXPECT_EQ(config.laser.pls.first_no_return_code, laser.first_no_return_code);
  const devices::BaseSettings base;
  EXPECT_EQ(config.base_port, "/dev/b");
  EXPECT_EQ(config.base.line, base.line);
  EXPECT_EQ(config.base.report_mask, base.report_mask);
  EXPECT_EQ(config.base.torque, base.torque);
  EXPECT_EQ(config.base.calibration.counts_per_m, base.calibration.counts_per_m);
}

TEST(DeviceConfig, KeysReachTheDrivers) {
  const DeviceConfig config = config_of(R"(
laser:
  port: /dev/a
  kind: lms
  baud: 38400
  detection_bauds: "38400 9600"
  settle_s: 0.5
  first_no_return_code: 8000
base:
  port: /dev/b
  baud: 38400
  dialect: binary
  counts_per_m: 25630
  torque: 20
odometry:
  wait_s: 0.15
)");
  EXPECT_THAT(config.laser.pls.parities, ElementsAre(devices::Parity::kNone));
  EXPECT_THAT(config.laser.pls.detection_bauds, ElementsAre(38'400U, 9600U));
  EXPECT_EQ(config.laser.pls.settle_ns, 500'000'000);
  EXPECT_EQ(config.laser.pls.first_no_return_code, 8000);
  EXPECT_EQ(config.base.dialect, devices::BaseDialect::kBinary);
  EXPECT_EQ(config.base.line.baud, 38'400U);
  EXPECT_EQ(config.base.calibration.counts_per_m, 25'630.0);
  EXPECT_EQ(config.base.torque, std::uint8_t{20});
  EXPECT_EQ(config.odometry_wait_ns, 150'000'000);
}

TEST(DeviceConfig, TheModelOfTheLaserChoosesItsDriver) {
  EXPECT_EQ(config_of("laser.port: /dev/a\n").laser.model->name, "sick_pls");
  const DeviceConfig config = config_of(R"(
laser:
  port: /dev/a
  model: ld19
  range_max_m: 8
  shortest_silence_s: 2
  beams: 360
  upside_down: true
  least_intensity: 20
  packet_delay_s: 0.002
)");
  EXPECT_EQ(config.laser.model, &devices::laser_model("ld19"));
  const devices::TurningLaserSettings& turning = config.laser.turning;
  EXPECT_EQ(turning.range_max_m, 8.0);
  EXPECT_EQ(turning.silence_ns, 2'000'000'000);
  EXPECT_EQ(turning.beams, 360U);
  EXPECT_TRUE(turning.upside_down);
  EXPECT_EQ(turning.least_intensity, 20);
  EXPECT_EQ(turning.packet_delay_ns, 2'000'000);
}

TEST(DeviceConfig, ASafetyScannerSendsDatagrams) {
  const DeviceConfig config = config_of(R"(
laser:
  port: udp://10.0.0.2
  model: sick_nanoscan3
  data_port: 6060
  safety_channel: 3
  safety_interface: profinet
  protective_path: 4
  warning_path: 5
)");
  EXPECT_EQ(config.laser_port, "udp://10.0.0.2:2122");
  EXPECT_EQ(config.laser_data_port, 6060);
  EXPECT_EQ(config.laser.safety.channel, 3);
  EXPECT_EQ(config.laser.safety.interface, devices::SafetyInterface::kProfinet);
  EXPECT_EQ(config.laser.safety.protective_path, 4);
  EXPECT_EQ(config.laser.safety.warning_path, 5);
}

TEST(DeviceConfig, TheModelOfTheBaseChoosesItsLineAndBattery) {
  const DeviceConfig b21 = config_of("base.port: /dev/b\n");
  EXPECT_EQ(b21.base.line.baud, 9600U);
  EXPECT_EQ(b21.base.battery_low_v, 44.0);
  const DeviceConfig create = config_of("base.port: /dev/b\nbase.model: create2\n");
  EXPECT_EQ(create.base.line.baud, 115'200U);
  EXPECT_EQ(create.base.battery_low_v, 13.0);
  const DeviceConfig given = config_of(R"(
base:
  port: /dev/b
  model: create2
  baud: 19200
  battery_low_v: 12.5
  create_track_m: 0.233
)");
  EXPECT_EQ(given.base.line.baud, 19'200U);
  EXPECT_EQ(given.base.battery_low_v, 12.5);
  EXPECT_EQ(given.base.create.track_m, 0.233);
}

TEST(DeviceConfig, BodySensorsAreThereWhereTheFileSaysSo) {
  EXPECT_EQ(config_of("base.port: /dev/b\n").body_sensors, BodySensorKind::kNone);
  EXPECT_EQ(config_of("base.port: /dev/b\nbody.sensors: b21\n").body_sensors, BodySensorKind::kB21);
}

TEST(DeviceConfig, PrintedFileReadsBackToTheSame) {
  DeviceFile file;
  file.laser.port = "/dev/ttyUSB0";
  file.base.settings.calibration.counts_per_m = 27'444.6;
  std::ostringstream text;
  support::write_yaml(describe(file), text);
  DeviceFile again;
  support::load_yaml_text(text.str(), "printed", describe(again));
  EXPECT_EQ(support::effective(describe(again)).fingerprint,
            support::effective(describe(file)).fingerprint);
}

/// When a key, its default or its reason changes, renew the example: topogeo config --devices
/// --config deploy/devices.example.yaml
TEST(DeviceConfig, ExampleNamesEveryKeyWithItsDefault) {
  DeviceFile file;
  const support::ConfigSchema schema = describe(file);
  file.laser.port = "/dev/ttyUSB0";
  file.base.port = "/dev/ttyUSB1";
  std::ostringstream expected;
  support::write_yaml(schema, expected);
  std::ifstream example(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "deploy/devices.example.yaml");
  const std::string text((std::istreambuf_iterator<char>(example)), {});
  EXPECT_EQ(text, expected.str());
}

TEST(DeviceConfig, ThePageOfDevicesHasARowForEachLaser) {
  std::ifstream page(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs/devices.md");
  const std::string text((std::istreambuf_iterator<char>(page)), {});
  for (const devices::LaserModel& model : devices::laser_models()) {
    const std::string beams = std::to_string(model.beams) + " over " +
                              std::to_string(std::lround(model.view_deg)) + " degrees";
    const std::string row = "| `" + std::string(model.name) + "` | " + std::string(model.title);
    const auto at = text.find(row);
    ASSERT_NE(at, std::string::npos) << row;
    EXPECT_THAT(text.substr(at, text.find('\n', at) - at), HasSubstr(beams));
  }
}

TEST(DeviceConfig, ThePageOfDevicesHasARowForEachBase) {
  std::ifstream page(std::filesystem::path(TOPOGEO_SOURCE_DIR) / "docs/devices.md");
  const std::string text((std::istreambuf_iterator<char>(page)), {});
  for (const devices::BaseModel& model : devices::base_models()) {
    EXPECT_THAT(text, HasSubstr("\n| `" + std::string(model.name) + "` | "));
  }
}

TEST(DeviceConfig, SonarsOfTheBaseFireOnlyIfTheyAreRead) {
  const std::string base = "base: {port: /dev/b, model: pioneer}\n";
  EXPECT_FALSE(config_of(base).base.pioneer.sonars);
  const DeviceConfig config = config_of(base + "body.sensors: base\n");
  EXPECT_TRUE(config.base.pioneer.sonars);
  EXPECT_EQ(config.body_sensors, BodySensorKind::kBase);
}

TEST(DeviceConfig, MistakesNameTheKey) {
  const auto why = [](const std::string& text) -> std::string {
    try {
      (void)config_of(text);
    } catch (const std::exception& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.speed: 3\n"), HasSubstr("laser.speed"));
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.baud: 12345\n"), HasSubstr("12345"));
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.detection_bauds: 9600,500000\n"),
              HasSubstr("laser.detection_bauds"));
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.password: short\n"), HasSubstr("password"));
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.model: ld20\n"), HasSubstr("ld19"));
  EXPECT_THAT(why("laser.port: /dev/a\nlaser.model: ld19\nlaser.beams: 10\n"), HasSubstr("beams"));
  EXPECT_THAT(why("laser.port: tcp://host\nlaser.model: sick_nanoscan3\n"), HasSubstr("udp://"));
  EXPECT_THAT(why("laser.port: udp://host\nlaser.model: ust_20lx\n"), HasSubstr("tcp://"));
  EXPECT_THAT(why("base.port: /dev/b\nbase.counts_per_m: -1\n"), HasSubstr("base.counts_per_m"));
  EXPECT_THAT(why("base.port: /dev/b\nbase.command_timeout_s: 2\n"),
              HasSubstr("base.command_timeout_s"));
  EXPECT_THAT(why("base: {port: /dev/b, model: kobuki}\nbody.sensors: base\n"),
              HasSubstr("body.sensors"));
  EXPECT_THAT(why("odometry.wait_s: 0\n"), HasSubstr("at least one port"));
  EXPECT_THAT(why("laser.port: /dev/a\nbase.port: /dev/a\n"), HasSubstr("another port"));
}

}  // namespace
}  // namespace topogeo::sensor_gateway
