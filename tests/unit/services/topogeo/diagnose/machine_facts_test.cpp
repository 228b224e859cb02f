// Queries of `topogeo doctor` to the system, with injected faults.
#include "topogeo/diagnose/machine_facts.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <unistd.h>

#include "topogeo/diagnose/network_probe.hpp"
#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A UDP socket at any free port, which cannot be shared.
class TakenPort {
 public:
  TakenPort() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    socklen_t size = sizeof address;
    if (::bind(socket_.get(), reinterpret_cast<sockaddr*>(&address), size) == 0 &&
        ::getsockname(socket_.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0) {
      port_ = ntohs(address.sin_port);
    }
  }
  [[nodiscard]] std::uint32_t port() const { return port_; }

 private:
  support::FileDescriptor socket_;
  std::uint32_t port_ = 0;
};

class MachineFactsTest : public testing::Test {
 protected:
  MachineFactsTest() {
    fs::create_directories(folder_ / "shm");
    fs::create_directories(folder_ / "dev");
    write("proc/net/udp", "titles\n");
    write("proc/net/route", "Iface Destination Gateway Flags RefCnt Use Metric Mask MTU\n");
    write("proc/sys/net/core/rmem_default", "212992\n");
    write("proc/sys/net/ipv4/ip_local_port_range", "32768\t60999\n");
    write("proc/meminfo", "MemTotal: 8000000 kB\nMemAvailable:    2000000 kB\n");
    write("proc/self/cgroup", "0::/system.slice/topogeo.service\n");
    questions_.map_folder = folder_ / "map";
    questions_.sources = {folder_ / "proc", folder_ / "cgroup", folder_ / "shm", folder_ / "dev"};
  }
  ~MachineFactsTest() override { fs::remove_all(folder_); }

  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((folder_ / file).parent_path());
    std::ofstream(folder_ / file) << text;
  }
  [[nodiscard]] MachineFacts facts() const { return gather_machine_facts(questions_); }

  fs::path folder_ =
      fs::path(testing::TempDir()) / ("machine_facts_test_" + std::to_string(::getpid()));
  MachineQuestions questions_;
};

TEST_F(MachineFactsTest, PortsOfTheDomainAreCounted) {
  questions_.domain = 3;  // 8150 (0x1FD6) shared, 8160 (0x1FE0) and up for the programs
  write("proc/net/udp",
        "titles\n"
        "   1: 00000000:1FD6 00000000:0000 07 0:0 0:0 0 0 0 11 2 0 0\n"
        "   2: 00000000:1FE0 00000000:0000 07 0:0 0:0 0 0 0 12 2 0 0\n"
        "   3: 00000000:1FE1 00000000:0000 07 0:0 0:0 0 0 0 13 2 0 0\n"
        "   4: 00000000:1CF2 00000000:0000 07 0:0 0:0 0 0 0 14 2 0 0\n");
  EXPECT_EQ(facts().discovery_port, 8150U);
  EXPECT_EQ(facts().used_ports, 2U);
  EXPECT_EQ(facts().first_ephemeral_port, 32768U);
  EXPECT_EQ(facts().last_ephemeral_port, 60999U);
}

TEST_F(MachineFactsTest, PortThatAProgramHasForItselfIsFoundWithTheProgram) {
  const TakenPort taken;
  ASSERT_GT(taken.port(), 0U);
  EXPECT_THAT(why_port_cannot_be_shared(taken.port()), Not(IsEmpty()));
  EXPECT_THAT(owner_of_udp_port(taken.port(), "/proc"),
              HasSubstr("(" + std::to_string(::getpid()) + ")"));
  std::uint32_t free_port = 0;
  {
    const TakenPort released;
    free_port = released.port();
  }
  EXPECT_EQ(why_port_cannot_be_shared(free_port), "");
  EXPECT_EQ(owner_of_udp_port(free_port, "/proc"), "");
}

TEST_F(MachineFactsTest, RouteToTheGroupOfDiscovery) {
  EXPECT_FALSE(facts().multicast_route);
  write("proc/net/route", "titles\nlo 000000E0 00000000 0001 0 0 0 000000F0 0 0 0\n");
  EXPECT_TRUE(facts().multicast_route) << "224.0.0.0/4";
  write("proc/net/route", "titles\neth0 0000A8C0 00000000 0001 0 0 0 0000FFFF 0 0 0\n");
  EXPECT_FALSE(facts().multicast_route) << "192.168.0.0/16";
  write("proc/net/route", "titles\neth0 00000000 0101A8C0 0003 0 0 0 00000000 0 0 0\n");
  EXPECT_TRUE(facts().multicast_route) << "default route";
}

TEST_F(MachineFactsTest, WhatTheDeadLeftInSharedMemory) {
  for (const char* name : {"fastrtps_0123456789abcdef", "fastrtps_1123456789abcdef"}) {
    write(std::string("shm/") + name, std::string(1000, 'x'));
    write(std::string("shm/") + name + "_el", "");
    fs::last_write_time(folder_ / "shm" / (std::string(name) + "_el"),
                        fs::file_time_type::clock::now() - std::chrono::hours(1));
  }
  const support::FileDescriptor alive(
      ::open((folder_ / "shm/fastrtps_1123456789abcdef_el").c_str(), O_RDONLY | O_CLOEXEC));
  ASSERT_EQ(::flock(alive.get(), LOCK_EX), 0);
  const MachineFacts found = facts();
  EXPECT_EQ(found.shared_memory_error, "");
  EXPECT_EQ(found.dead_segments, 1U);
  EXPECT_EQ(found.dead_bytes, 1000U);
  EXPECT_TRUE(fs::exists(folder_ / "shm/fastrtps_0123456789abcdef")) << "it removes nothing";
  questions_.sources.shared_memory = folder_ / "none";
  EXPECT_THAT(facts().shared_memory_error, HasSubstr("is no folder"));
}

TEST_F(MachineFactsTest, UdevRuleAndModemManagerAreFound) {
  questions_.sources.udev_rules = {folder_ / "none", folder_ / "rules.d"};
  questions_.sources.proc = folder_ / "proc";
  EXPECT_FALSE(facts().udev_rule);
  EXPECT_FALSE(facts().modem_manager);
  write("rules.d/60-topogeo.rules", "");
  write("proc/12/comm", "sh\n");
  write("proc/345/comm", "ModemManager\n");
  EXPECT_TRUE(facts().udev_rule);
  EXPECT_TRUE(facts().modem_manager);
}

TEST_F(MachineFactsTest, SerialPortsAreThoseOfTheFileOrThoseFound) {
  write("dev/ttyUSB1", "");
  write("dev/ttyACM0", "");
  write("dev/tty1", "");
  MachineFacts found = facts();
  ASSERT_EQ(found.serial_ports.size(), 2U);
  EXPECT_EQ(found.serial_ports[0].path, (folder_ / "dev/ttyACM0").string());
  EXPECT_TRUE(found.serial_ports[0].exists && found.serial_ports[0].accessible);
  EXPECT_THAT(found.serial_ports[0].group, Not(IsEmpty()));
  EXPECT_FALSE(found.serial_ports[0].named);
  write("devices.yaml", "laser:\n  port: " + (folder_ / "dev/ttyUSB7").string() + "\n");
  questions_.devices = folder_ / "devices.yaml";
  found = facts();
  ASSERT_EQ(found.serial_ports.size(), 1U);
  EXPECT_TRUE(found.serial_ports[0].named);
  EXPECT_FALSE(found.serial_ports[0].exists);
  write("devices.yaml", "lase: 1\n");
  EXPECT_THAT(facts().devices_error, HasSubstr("lase"));
}

TEST_F(MachineFactsTest, FolderOfTheMap) {
  EXPECT_EQ(facts().map_folder_error, "") << "it is made when it is needed";
  EXPECT_FALSE(fs::exists(folder_ / "map"));
  EXPECT_GT(facts().disk_free_bytes, 0U);
  write("file", "");
  questions_.map_folder = folder_ / "file/map";
  EXPECT_THAT(facts().map_folder_error, HasSubstr("file"));
  fs::create_symlink("loop", folder_ / "loop");
  questions_.map_folder = folder_ / "loop/map";
  EXPECT_THAT(facts().map_folder_error, HasSubstr("loop"));
}

TEST_F(MachineFactsTest, FolderOfTheMapThatOthersMayNotLookInto) {
  fs::create_directories(folder_ / "state/map/of/one");
  fs::permissions(folder_ / "state", fs::perms::none);
  questions_.map_folder = folder_ / "state/map/of/one";
  // Root can read any folder.
  const bool root = ::geteuid() == 0;
  constexpr uid_t kNobody = 65534;
  if (root) {
    ASSERT_EQ(::seteuid(kNobody), 0);
  }
  const MachineFacts found = facts();
  if (root) {
    ASSERT_EQ(::seteuid(0), 0);
  }
  EXPECT_EQ(found.closed_folder, (folder_ / "state").string());
  EXPECT_EQ(found.map_folder_error, "");
  EXPECT_GT(found.disk_free_bytes, 0U);
  fs::permissions(folder_ / "state", fs::perms::owner_all);
  questions_.map_folder = folder_ / "map";
  EXPECT_EQ(facts().closed_folder, "");
}

TEST_F(MachineFactsTest, VariablesThatMakeMulticastNeedless) {
  const auto found_by = [&](const char* servers, const char* peers) {
    ::setenv("ROS_DISCOVERY_SERVER", servers, 1);
    ::setenv("TOPOGEO_PEERS", peers, 1);
    std::string by = facts().found_by;
    ::unsetenv("ROS_DISCOVERY_SERVER");
    ::unsetenv("TOPOGEO_PEERS");
    return by;
  };
  EXPECT_EQ(found_by("", ""), "");
  EXPECT_EQ(found_by("", ";"), "") << "names no host";
  EXPECT_EQ(found_by("", "10.0.0.1;10.0.0.2"), "TOPOGEO_PEERS");
  EXPECT_EQ(found_by("10.0.0.1:11811", ""), "ROS_DISCOVERY_SERVER");
  EXPECT_FALSE(facts().secured);
  ::setenv("TOPOGEO_SECURITY", "/etc/topogeo/security", 1);
  EXPECT_TRUE(facts().secured);
  ::unsetenv("TOPOGEO_SECURITY");
}

TEST_F(MachineFactsTest, MemoryAndTheLeastOfItsLimits) {
  EXPECT_EQ(facts().memory_available_bytes, 2'048'000'000U);
  EXPECT_EQ(facts().receive_buffer_bytes, 212'992U);
  fs::remove(folder_ / "proc/sys/net/core/rmem_default");
  EXPECT_EQ(facts().receive_buffer_bytes, receive_buffer_of_a_socket());
  EXPECT_GT(receive_buffer_of_a_socket(), 1'000U);
  const auto without = facts().memory_limit_bytes;
  write("cgroup/system.slice/topogeo.service/memory.max", "max\n");
  EXPECT_EQ(facts().memory_limit_bytes, without);
  write("cgroup/system.slice/topogeo.service/memory.max", "200000000\n");
  EXPECT_EQ(facts().memory_limit_bytes, 200'000'000U);
  write("cgroup/system.slice/memory.max", "100000000\n");
  EXPECT_EQ(facts().memory_limit_bytes, 100'000'000U) << "of the slice above";
}

}  // namespace
}  // namespace topogeo::cli
