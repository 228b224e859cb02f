// Services among the processes of a host, from a folder like /proc.
#include "topogeo/common/host_processes.hpp"

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "topogeo/support/host.hpp"

namespace topogeo::cli {
namespace {

class HostProcesses : public testing::Test {
 protected:
  HostProcesses() {
    std::filesystem::create_directories(proc_);
    write(proc_ / "uptime", "1000.00 1900.00\n");
  }
  ~HostProcesses() override { std::filesystem::remove_all(proc_); }

  static void write(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
  }
  /// Adds a process in that state that was started `age_s` ago.
  void add(int pid, const std::vector<std::string>& words, char state = 'S', double age_s = 60.0) {
    const std::filesystem::path folder = proc_ / std::to_string(pid);
    std::filesystem::create_directories(folder);
    std::string line;
    for (const std::string& word : words) line += word + '\0';
    write(folder / "cmdline", line);
    const auto start =
        static_cast<long>((1000.0 - age_s) * static_cast<double>(::sysconf(_SC_CLK_TCK)));
    std::string stat = std::to_string(pid) + " (a (b) c) " + state;
    for (int field = 4; field < 22; ++field) stat += " 7";
    write(folder / "stat", stat + " " + std::to_string(start) + " 0 0\n");
  }

  std::filesystem::path proc_ = std::filesystem::temp_directory_path() /
                                ("topogeo_host_processes_" + std::to_string(::getpid()));
};

TEST_F(HostProcesses, AreServicesOfThisProjectAlone) {
  add(30, {"/usr/bin/topogeo-local-mapper", "--domain", "7", "--robot", "r1"});
  add(4, {"/opt/build/bin/localizer", "--domain=3", "--partition", "run-1"}, 'T', 4.0);
  add(5, {"/usr/bin/web-browser", "localizer"});
  add(6, {"topogeo", "status"});
  add(7, {"planner"}, 'Z');
  std::filesystem::create_directories(proc_ / "self");
  const std::vector<HostProcess> found = host_processes(proc_);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].pid, 4);
  EXPECT_EQ(found[0].service, "localizer");
  EXPECT_EQ(found[0].domain, 3U);
  EXPECT_EQ(found[0].partition, "run-1");
  EXPECT_TRUE(found[0].stopped);
  EXPECT_NEAR(found[0].age_s, 4.0, 0.1);
  EXPECT_EQ(found[1].service, "local_mapper");
  EXPECT_EQ(found[1].domain, 7U);
  EXPECT_EQ(found[1].partition, "topogeo");
  EXPECT_FALSE(found[1].stopped);
}

TEST_F(HostProcesses, HaveTheDomainOfTheirEnvironment) {
  add(9, {"planner"});
  const std::string environment("A=1\0TOPOGEO_DOMAIN=5\0B=2\0", 25);
  write(proc_ / "9/environ", environment);
  const std::vector<HostProcess> found = host_processes(proc_);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].domain, 5U);
}

TEST_F(HostProcesses, HaveTheNumberThatTheyHaveInTheirContainer) {
  add(8, {"planner"});
  add(9, {"planner"});
  write(proc_ / "8/status", "Name:\tplanner\nPid:\t8\nNSpid:\t8\t17\t3\nThreads:\t1\n");
  const std::vector<HostProcess> found = host_processes(proc_);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].pid, 8);
  EXPECT_EQ(found[0].own_pid, 3);
  EXPECT_EQ(found[1].own_pid, 9) << "an old kernel does not tell";
}

TEST_F(HostProcesses, AreThoseWithTheSameHostName) {
  add(9, {"planner"});
  add(10, {"localizer"});
  add(11, {"navigator"});
  add(12, {"map_store"});
  add(13, {"planner"});
  const auto set_namespaces = [this](const std::string& process, const std::string& uts,
                                     const std::string& pid) {
    std::filesystem::create_directories(proc_ / process / "ns");
    std::filesystem::create_symlink(uts, proc_ / process / "ns/uts");
    std::filesystem::create_symlink(pid, proc_ / process / "ns/pid");
  };
  set_namespaces("self", "uts:[1]", "pid:[1]");
  set_namespaces("9", "uts:[2]", "pid:[2]");
  set_namespaces("10", "uts:[1]", "pid:[1]");
  // In containers, of which one is on the network of the host.
  set_namespaces("11", "uts:[3]", "pid:[3]");
  write(proc_ / "11/environ", "HOSTNAME=" + support::host_name() + '\0');
  set_namespaces("12", "uts:[4]", "pid:[4]");
  write(proc_ / "12/environ", std::string("HOSTNAME=another host\0", 22));
  // A unit of systemd with ProtectHostname.
  set_namespaces("13", "uts:[5]", "pid:[1]");
  const std::vector<HostProcess> found = host_processes(proc_);
  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].service, "localizer");
  EXPECT_EQ(found[1].service, "navigator");
  EXPECT_EQ(found[2].service, "planner");
}

TEST_F(HostProcesses, AreThoseOfTheSameNetwork) {
  add(9, {"planner"});
  add(10, {"localizer"});
  for (const char* process : {"self", "9", "10"}) {
    std::filesystem::create_directories(proc_ / process / "ns");
  }
  std::filesystem::create_symlink("net:[1]", proc_ / "self/ns/net");
  std::filesystem::create_symlink("net:[1]", proc_ / "9/ns/net");
  std::filesystem::create_symlink("net:[2]", proc_ / "10/ns/net");
  const std::vector<HostProcess> found = host_processes(proc_);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].service, "planner");
}

TEST_F(HostProcesses, AreNoneWithoutProc) {
  EXPECT_TRUE(host_processes(proc_ / "nothing").empty());
}

}  // namespace
}  // namespace topogeo::cli
