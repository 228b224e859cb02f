#include "topogeo/devices/network_address.hpp"

#include <stdexcept>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

TEST(NetworkAddress, HasAHostAndMayHaveAPort) {
  EXPECT_EQ(network_address("tcp://192.168.0.10:10940"), (NetworkAddress{"192.168.0.10", 10940}));
  EXPECT_EQ(network_address("tcp://laser.local"), (NetworkAddress{"laser.local", {}}));
  EXPECT_EQ(network_address("tcp://[fe80::1]:2112"), (NetworkAddress{"fe80::1", 2112}));
  EXPECT_EQ(network_address("tcp://[::1]"), (NetworkAddress{"::1", {}}));
}

TEST(NetworkAddress, ADeviceThatSendsDatagramsHasItsPortForCommands) {
  EXPECT_EQ(network_address("udp://10.0.0.1:2122"), (NetworkAddress{"10.0.0.1", 2122, true}));
  EXPECT_TRUE(is_network_address("udp://10.0.0.1"));
  EXPECT_EQ(with_port("udp://10.0.0.1", 2122), "udp://10.0.0.1:2122");
}

TEST(NetworkAddress, OtherPathsAreRefused) {
  for (const char* path :
       {"/dev/ttyUSB0", "tcp://", "tcp://:1", "tcp://host:", "tcp://host:0", "tcp://host:65536",
        "tcp://host:1x", "tcp://[::1", "tcp://a/b:1", "tcp://[::1]2", "udp://", "udp://:1"}) {
    EXPECT_THROW((void)network_address(path), std::invalid_argument) << path;
  }
  EXPECT_FALSE(is_network_address("/dev/ttyUSB0"));
  EXPECT_TRUE(is_network_address("tcp://host"));
}

TEST(NetworkAddress, TheModelHasThePortThatIsNotGiven) {
  EXPECT_EQ(with_port("tcp://host", 10940), "tcp://host:10940");
  EXPECT_EQ(with_port("tcp://[::1]", 10940), "tcp://[::1]:10940");
  EXPECT_EQ(with_port("tcp://host:5", 10940), "tcp://host:5");
  EXPECT_EQ(with_port("tcp://host", 0), "tcp://host");
  EXPECT_EQ(with_port("/dev/ttyUSB0", 10940), "/dev/ttyUSB0");
}

}  // namespace
}  // namespace topogeo::devices
