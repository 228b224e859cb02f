#include "diagnose/port_names.hpp"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

class PortNames : public testing::Test {
 protected:
  PortNames() {
    fs::create_directories(dev_ / "serial" / "by-id");
    for (const char* name : {"ttyUSB1", "ttyUSB0", "ttyACM0", "ttyAMA0", "tty1", "ttyS0", "null"}) {
      std::ofstream(dev_ / name).flush();
    }
    fs::create_symlink("../../ttyUSB1", dev_ / "serial/by-id/usb-Maker_of_lasers_0001-if00-port0");
    fs::create_symlink("../../ttyUSB9", dev_ / "serial/by-id/usb-Unplugged");
  }
  ~PortNames() override { fs::remove_all(dev_); }

  fs::path dev_ = fs::temp_directory_path() / ("port_names_" + std::to_string(::getpid()));
};

TEST_F(PortNames, UsbPortsAndUartsAreListed) {
  EXPECT_THAT(serial_ports(dev_),
              ElementsAre(dev_ / "ttyACM0", dev_ / "ttyAMA0", dev_ / "ttyUSB0", dev_ / "ttyUSB1"));
  EXPECT_TRUE(serial_ports(dev_ / "none").empty());
}

TEST_F(PortNames, TheLastingNameIsThatOfTheAdapter) {
  EXPECT_EQ(lasting_name(dev_ / "ttyUSB1", dev_),
            dev_ / "serial/by-id/usb-Maker_of_lasers_0001-if00-port0");
  EXPECT_EQ(lasting_name(dev_ / "ttyUSB0", dev_), dev_ / "ttyUSB0");
  EXPECT_EQ(lasting_name(dev_ / "ttyUSB9", dev_), dev_ / "ttyUSB9");
}

}  // namespace
}  // namespace topogeo::cli
