#include "diagnose/device_report.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace topogeo::cli {
namespace {

using devices::DeviceKind;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

SearchedPort laser(const char* port, const char* model, std::uint32_t baud) {
  SearchedPort found;
  found.port = port;
  found.name = std::string("/dev/serial/by-id/usb-of-") + model;
  found.device = {DeviceKind::kLaser, model, {baud, devices::Parity::kNone}};
  return found;
}

std::vector<SearchedPort> two_lasers_and_a_base() {
  std::vector<SearchedPort> ports{laser("/dev/ttyUSB0", "ld19", 230'400),
                                  laser("/dev/ttyUSB1", "rplidar_a2", 115'200)};
  ports[0].device->note = "an ld06 sends the same";
  ports[1].device->device = "model 40, firmware 1.29";
  ports[1].asked = true;
  SearchedPort base;
  base.port = base.name = "/dev/ttyACM0";
  base.device = {DeviceKind::kBase, "microcontroller", {57'600, devices::Parity::kNone}, "cart"};
  ports.push_back(base);
  SearchedPort silent;
  silent.port = silent.name = "/dev/ttyUSB2";
  silent.why_none = "sends nothing and answers no question";
  ports.push_back(silent);
  SearchedPort closed;
  closed.port = closed.name = "/dev/ttyUSB3";
  closed.error = "/dev/ttyUSB3: cannot open: Permission denied";
  ports.push_back(closed);
  return ports;
}

TEST(DeviceReport, EachPortHasItsOutcomeAndSettings) {
  EXPECT_EQ(
      ports_text(two_lasers_and_a_base()),
      "/dev/ttyUSB0\n"
      "  laser    LDROBOT LD19 (also sold as D300), sends at 230400 baud; an ld06 sends the same\n"
      "  settings laser: {port: /dev/serial/by-id/usb-of-ld19, model: ld19}\n"
      "/dev/ttyUSB1\n"
      "  laser    Slamtec RPLIDAR A2 (A2M8), answers at 115200 baud, model 40, firmware 1.29\n"
      "  settings laser: {port: /dev/serial/by-id/usb-of-rplidar_a2, model: rplidar_a2}\n"
      "/dev/ttyACM0\n"
      "  base     any microcontroller with the line protocol (docs/base_protocol.md), sends at "
      "57600 baud, cart\n"
      "  settings base: {port: /dev/ttyACM0, model: microcontroller, baud: 57600}\n"
      "/dev/ttyUSB2\n"
      "  unknown  sends nothing and answers no question\n"
      "/dev/ttyUSB3\n"
      "  problem  /dev/ttyUSB3: cannot open: Permission denied\n");
}

TEST(DeviceReport, TheFileHasOneLaserAndOneBase) {
  const std::string file = devices_file(two_lasers_and_a_base());
  EXPECT_THAT(file, HasSubstr("\nlaser:\n  port: /dev/serial/by-id/usb-of-ld19\n  model: ld19\n"));
  EXPECT_THAT(file, HasSubstr("\n#   port: /dev/serial/by-id/usb-of-rplidar_a2\n"));
  EXPECT_THAT(
      file, HasSubstr("\nbase:\n  port: /dev/ttyACM0\n  model: microcontroller\n  baud: 57600\n"));
  EXPECT_THAT(file, HasSubstr("ticks_per_m"));
}

TEST(DeviceReport, NoDeviceMakesNoFile) {
  SearchedPort silent;
  silent.why_none = "sends nothing, and was not asked";
  EXPECT_THAT(devices_file({&silent, 1}), IsEmpty());
}

TEST(DeviceReport, ProgramsGetTheSame) {
  const auto report = nlohmann::json::parse(ports_json(two_lasers_and_a_base()));
  ASSERT_EQ(report["ports"].size(), 5U);
  EXPECT_EQ(report["ports"][0]["kind"], "laser");
  EXPECT_EQ(report["ports"][0]["model"], "ld19");
  EXPECT_EQ(report["ports"][0]["asked"], false);
  EXPECT_EQ(report["ports"][2]["baud"], 57'600);
  EXPECT_TRUE(report["ports"][3]["kind"].is_null());
  EXPECT_EQ(report["ports"][4]["problem"], "/dev/ttyUSB3: cannot open: Permission denied");
}

}  // namespace
}  // namespace topogeo::cli
