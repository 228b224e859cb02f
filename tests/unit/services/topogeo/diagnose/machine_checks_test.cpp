// Each fault of a machine that `topogeo doctor` must find, injected into its facts.
#include "topogeo/diagnose/machine_checks.hpp"

#include <set>
#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace topogeo::cli {
namespace {

using testing::AllOf;
using testing::Each;
using testing::Field;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

MachineFacts healthy() {
  MachineFacts facts;
  facts.user = "robot";
  facts.discovery_port = 7400;
  facts.used_ports = 14;
  facts.first_ephemeral_port = 32768;
  facts.last_ephemeral_port = 60999;
  facts.multicast = {{"eth0", ""}};
  facts.multicast_route = true;
  facts.receive_buffer_bytes = 1'048'576;
  facts.uses_shared_memory = true;
  facts.shared_memory_free_bytes = 2'000'000'000;
  facts.serial_ports = {{"/dev/ttyUSB0", true, true, "dialout", true}};
  facts.map_folder = "/var/lib/topogeo/map";
  facts.disk_free_bytes = 50'000'000'000;
  facts.cpu.processors = 2;
  facts.cpu.load = 2.5;
  facts.cpu.pressure_share = 0.3;
  facts.memory_available_bytes = 4'000'000'000;
  facts.open_files_limit = 1024;
  return facts;
}

/// Findings that are not good.
std::vector<Finding> found_in(const MachineFacts& facts) {
  std::vector<Finding> findings = run_checks(machine_checks(), facts);
  std::erase_if(findings, [](const Finding& f) { return f.severity == Severity::kGood; });
  return findings;
}

struct MachineFault {
  const char* name;
  const char* check;
  Severity severity;
  const char* what;    ///< part of the message
  const char* remedy;  ///< part of the remedy
  void (*inject)(MachineFacts& facts);
};

const std::vector<MachineFault>& machine_faults() {
  static const std::vector<MachineFault> kFaults = {
      {"PortTaken", "ports", Severity::kProblem, "UDP port 7400 of domain 0", "end that program",
       [](MachineFacts& f) {
         f.discovery_port_error = "Address already in use";
         f.discovery_port_owner = "nc (17)";
       }},
      {"PortsUsedUp", "ports", Severity::kProblem, "230 UDP ports", "--domain",
       [](MachineFacts& f) { f.used_ports = 230; }},
      {"PortsOfTheSystem", "ports", Severity::kHint, "32768 to 60999", "below 100",
       [](MachineFacts& f) {
         f.domain = 110;
         f.discovery_port = 7400 + 250 * 110;
       }},
      {"NoInterface", "multicast", Severity::kProblem, "no network interface", "ip link set dev",
       [](MachineFacts& f) { f.multicast.clear(); }},
      {"MulticastLost", "multicast", Severity::kProblem, "eth0: a packet to 239.255.0.1 is lost",
       "ROS_DISCOVERY_SERVER",
       [](MachineFacts& f) { f.multicast[0].error = "nothing comes back"; }},
      {"MulticastLostToTheSecured", "multicast", Severity::kProblem, "eth0: a packet",
       "TOPOGEO_PEERS",
       [](MachineFacts& f) {
         f.multicast[0].error = "nothing comes back";
         f.secured = true;
       }},
      {"NoInterfaceForTheSecured", "multicast", Severity::kProblem, "no network interface",
       "TOPOGEO_PEERS",
       [](MachineFacts& f) {
         f.multicast.clear();
         f.secured = true;
       }},
      {"NoRoute", "route", Severity::kProblem, "no route leads to 239.255.0.1",
       "ip route add 239.255.0.0/16 dev eth0", [](MachineFacts& f) { f.multicast_route = false; }},
      {"SmallBuffers", "UDP buffers", Severity::kProblem, "65 KB", "sysctl -w net.core.rmem_max",
       [](MachineFacts& f) { f.receive_buffer_bytes = 65'536; }},
      {"PoorBuffers", "UDP buffers", Severity::kHint, "212 KB", "sysctl",
       [](MachineFacts& f) { f.receive_buffer_bytes = 212'992; }},
      {"NoSharedMemory", "shared memory", Severity::kProblem, "read-only", "PARTICIPANT=local",
       [](MachineFacts& f) { f.shared_memory_error = "/dev/shm: read-only file system"; }},
      {"LeftBehind", "shared memory", Severity::kProblem, "3 segments (12 MB)",
       "rm /dev/shm/fastrtps_",
       [](MachineFacts& f) {
         f.dead_segments = 3;
         f.dead_bytes = 12'000'000;
       }},
      {"SharedMemoryFull", "shared memory", Severity::kProblem, "4 MB are free", "--shm-size",
       [](MachineFacts& f) { f.shared_memory_free_bytes = 4'000'000; }},
      {"SharedMemoryShort", "shared memory", Severity::kHint, "30 MB are free", "--shm-size",
       [](MachineFacts& f) { f.shared_memory_free_bytes = 30'000'000; }},
      {"DevicesFileWrong", "serial ports", Severity::kProblem, "unknown key", "topogeo config",
       [](MachineFacts& f) { f.devices_error = "devices.yaml:3: unknown key 'lase'"; }},
      {"PortUnplugged", "serial ports", Severity::kProblem, "/dev/ttyUSB0 does not exist",
       "plug it in", [](MachineFacts& f) { f.serial_ports[0].exists = false; }},
      {"NotInDialout", "serial ports", Severity::kProblem,
       "/dev/ttyUSB0 is closed to robot: it belongs to group dialout", "usermod -aG dialout robot",
       [](MachineFacts& f) { f.serial_ports[0].accessible = false; }},
      {"GatewayNotInDialout", "serial ports", Severity::kProblem,
       "closed to topogeo-sensor-gateway", "usermod -aG dialout topogeo-sensor-gateway",
       [](MachineFacts& f) {
         f.serial_ports[0].accessible = false;
         f.serial_ports[0].user = "topogeo-sensor-gateway";
       }},
      {"UnnamedPortClosed", "serial ports", Severity::kHint, "closed to robot", "usermod",
       [](MachineFacts& f) {
         f.serial_ports[0].accessible = false;
         f.serial_ports[0].named = false;
       }},
      {"RuleMissing", "udev rule", Severity::kHint, "ModemManager runs", "60-topogeo.rules",
       [](MachineFacts& f) { f.modem_manager = true; }},
      {"DiskFull", "disk", Severity::kProblem, "50 MB are free for /var/lib/topogeo/map",
       "make room", [](MachineFacts& f) { f.disk_free_bytes = 50'000'000; }},
      {"DiskShort", "disk", Severity::kHint, "900 MB are free", "make room",
       [](MachineFacts& f) { f.disk_free_bytes = 900'000'000; }},
      {"MapFolderClosed", "map folder", Severity::kProblem, "robot cannot write there",
       "install -d -o robot /var/lib/topogeo/map",
       [](MachineFacts& f) { f.map_folder_error = "/var/lib/topogeo/map: Permission denied"; }},
      {"MapFolderOutOfSight", "map folder", Severity::kProblem,
       "robot cannot look into /var/lib/topogeo", "sudo -u topogeo",
       [](MachineFacts& f) { f.closed_folder = "/var/lib/topogeo"; }},
      {"ManyThreadsForFewCpus", "CPU", Severity::kHint,
       "the CPU is short: 4.0 threads for each CPU (2 processors, load 8.0", "ga_worker",
       [](MachineFacts& f) {
         f.cpu.load = 8.0;
         f.cpu.pressure_share = 0.98;
       }},
      {"QuotaThatStopsPrograms", "CPU", Severity::kHint, "a quota of 0.8 CPUs has stopped programs",
       "CPUQuota=",
       [](MachineFacts& f) {
         f.cpu.quota = 0.8;
         f.cpu.quota_periods = 1000;
         f.cpu.throttled_periods = 630;
       }},
      {"MemoryLimit", "memory", Severity::kProblem, "no more than 100 MB", "MemoryMax",
       [](MachineFacts& f) { f.memory_limit_bytes = 100'000'000; }},
      {"MemoryUsedUp", "memory", Severity::kProblem, "100 MB are free", "end other programs",
       [](MachineFacts& f) { f.memory_available_bytes = 100'000'000; }},
      {"MemoryShort", "memory", Severity::kHint, "700 MB are free", "to a PC",
       [](MachineFacts& f) { f.memory_available_bytes = 700'000'000; }},
      {"FewFiles", "open files", Severity::kProblem, "64 files", "ulimit -n",
       [](MachineFacts& f) { f.open_files_limit = 64; }},
  };
  return kFaults;
}

TEST(MachineChecks, TheRuleMakesModemManagerHarmlessAndOpensPorts) {
  MachineFacts facts = healthy();
  facts.modem_manager = facts.udev_rule = true;
  EXPECT_THAT(found_in(facts), IsEmpty());
  facts.serial_ports[0].accessible = false;
  EXPECT_THAT(found_in(facts)[0].remedy, Not(HasSubstr("60-topogeo.rules")));
  facts.udev_rule = facts.modem_manager = false;
  EXPECT_THAT(found_in(facts)[0].remedy, HasSubstr("60-topogeo.rules"));
}

TEST(MachineChecks, AHealthyMachineHasNoFinding) {
  EXPECT_THAT(found_in(healthy()), IsEmpty());
  EXPECT_THAT(run_checks(machine_checks(), healthy()), Each(Field(&Finding::what, Not(IsEmpty()))))
      << "what is well is reported, too";
}

class MachineFaultTest : public testing::TestWithParam<MachineFault> {};

TEST_P(MachineFaultTest, IsFoundAndNothingElse) {
  const MachineFault& fault = GetParam();
  MachineFacts facts = healthy();
  fault.inject(facts);
  const std::vector<Finding> found = found_in(facts);
  ASSERT_EQ(found.size(), 1U) << findings_text(found);
  EXPECT_EQ(found[0].check, fault.check);
  EXPECT_EQ(found[0].severity, fault.severity);
  EXPECT_THAT(found[0].what, HasSubstr(fault.what));
  EXPECT_THAT(found[0].why, Not(IsEmpty()));
  EXPECT_THAT(found[0].remedy, HasSubstr(fault.remedy));
}

INSTANTIATE_TEST_SUITE_P(All, MachineFaultTest, testing::ValuesIn(machine_faults()),
                         [](const auto& fault) { return std::string(fault.param.name); });

TEST(MachineChecks, EachHasAFaultThatIsInjected) {
  std::set<std::string> injected;
  for (const MachineFault& fault : machine_faults()) injected.insert(fault.check);
  for (const Check<MachineFacts>& check : machine_checks()) {
    EXPECT_TRUE(injected.contains(check.name)) << check.name;
  }
}

TEST(MachineChecks, ALoadThatIsOverAndAQuotaThatSufficesAreNoFault) {
  MachineFacts facts = healthy();
  facts.cpu.load = 8.0;  // load of the last minute; now hardly a thread waits
  facts.cpu.quota = 1.5;
  facts.cpu.quota_periods = 1000;
  facts.cpu.throttled_periods = 30;  // from its start
  EXPECT_THAT(found_in(facts), IsEmpty());
}

TEST(MachineChecks, WhatIsNotUsedNeedNotWork) {
  MachineFacts facts = healthy();
  facts.multicast.clear();
  facts.multicast_route = false;
  facts.uses_shared_memory = false;
  facts.shared_memory_error = "/dev/shm: is no folder";
  for (const std::string variable : {"ROS_DISCOVERY_SERVER", "TOPOGEO_PEERS"}) {
    facts.found_by = variable;
    EXPECT_THAT(found_in(facts), IsEmpty());
    EXPECT_THAT(findings_text(run_checks(machine_checks(), facts)),
                AllOf(HasSubstr("multicast         not needed: " + variable + " is set"),
                      HasSubstr("route             not needed: " + variable + " is set")));
  }
}

TEST(MachineChecks, AMachineByItselfNeedsNoRoute) {
  MachineFacts facts = healthy();
  facts.multicast = {{"lo", "", true}};
  facts.multicast_route = false;
  EXPECT_THAT(found_in(facts), IsEmpty());
  EXPECT_THAT(findings_text(run_checks(machine_checks(), facts)),
              HasSubstr("not needed: only lo is up"));
  facts.multicast[0].error = "nothing comes back";
  EXPECT_THAT(found_in(facts), testing::SizeIs(2));
}

TEST(DoctorReport, TextAndJsonHaveEverything) {
  MachineFacts facts = healthy();
  facts.discovery_port_error = "Address already in use";
  facts.receive_buffer_bytes = 212'992;
  const std::vector<Finding> findings = run_checks(machine_checks(), facts);
  const std::string text = findings_text(findings);
  EXPECT_THAT(text, HasSubstr("problem  ports             UDP port 7400 of domain 0"));
  EXPECT_THAT(text, HasSubstr("         why  services discover each other there\n"));
  EXPECT_THAT(text, HasSubstr("         do   end that program"));
  EXPECT_THAT(text, HasSubstr("ok       memory            4000 MB are free\n"));
  EXPECT_THAT(text, HasSubstr("1 problem, 1 hint\n"));
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), kColumns) << line;
  const auto json = nlohmann::json::parse(findings_json(findings));
  EXPECT_EQ(json["problems"], 1);
  EXPECT_EQ(json["hints"], 1);
  EXPECT_EQ(json["findings"].size(), findings.size());
  EXPECT_EQ(json["findings"][0]["check"], "ports");
  EXPECT_EQ(json["findings"][0]["severity"], "problem");
  EXPECT_THAT(json["findings"][0]["remedy"].get<std::string>(), HasSubstr("ss -ulnp"));
}

}  // namespace
}  // namespace topogeo::cli
