// The CPUs of a machine, from made-up files of /proc and of control groups.
#include "topogeo/support/machine_cpu.hpp"

#include <fstream>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::support {
namespace {

namespace fs = std::filesystem;

class MachineCpuTest : public testing::Test {
 protected:
  void write(const std::string& file, const std::string& text) const {
    fs::create_directories((folder_.path() / file).parent_path());
    std::ofstream(folder_.path() / file) << text;
  }
  [[nodiscard]] MachineCpu read() const {
    return read_machine_cpu({folder_.path() / "proc", folder_.path() / "cgroup"});
  }

  TemporaryFolder folder_{"machine_cpu_test"};
};

TEST_F(MachineCpuTest, LoadAndPressure) {
  write("proc/loadavg", "7.25 3.20 1.41 3/180 4711\n");
  write("proc/pressure/cpu",
        "some avg10=98.50 avg60=89.59 avg300=59.06 total=328815202\n"
        "full avg10=0.00 avg60=0.00 avg300=0.00 total=0\n");
  const MachineCpu machine = read();
  EXPECT_GE(machine.processors, 1U);
  EXPECT_DOUBLE_EQ(machine.load, 7.25);
  ASSERT_TRUE(machine.pressure_share);
  EXPECT_DOUBLE_EQ(*machine.pressure_share, 0.985);
  EXPECT_FALSE(machine.quota);
  EXPECT_THAT(describe(machine), testing::HasSubstr("load 7.2"));
  EXPECT_THAT(describe(machine), testing::HasSubstr("98 % of the time"));
}

TEST_F(MachineCpuTest, WhatTheKernelDoesNotShowIsLeftOut) {
  const MachineCpu machine = read();
  EXPECT_FALSE(machine.pressure_share);
  EXPECT_FALSE(machine.quota);
  EXPECT_EQ(machine.available(), machine.processors);
}

TEST_F(MachineCpuTest, QuotaOfVersion2IsTheLeastOfTheGroupsAbove) {
  write("proc/self/cgroup", "0::/system.slice/robot.service\n");
  write("cgroup/system.slice/robot.service/cpu.max", "max 100000\n");
  write("cgroup/system.slice/cpu.max", "40000 50000\n");
  write("cgroup/system.slice/cpu.stat",
        "usage_usec 17\nnr_periods 100\nnr_throttled 60\nthrottled_usec 5\n");
  const MachineCpu machine = read();
  ASSERT_TRUE(machine.quota);
  EXPECT_DOUBLE_EQ(*machine.quota, 0.8);
  EXPECT_DOUBLE_EQ(machine.available(), 0.8);
  EXPECT_EQ(machine.quota_periods, 100U);
  EXPECT_EQ(machine.throttled_periods, 60U);
  EXPECT_THAT(describe(machine), testing::HasSubstr("a quota of 0.8 CPUs"));
}

TEST_F(MachineCpuTest, QuotaOfVersion1) {
  write("proc/self/cgroup", "5:cpuacct,cpu:/docker/abc\n4:memory:/docker/abc\n0::/\n");
  write("cgroup/cpuacct,cpu/docker/abc/cpu.cfs_quota_us", "5000\n");
  write("cgroup/cpuacct,cpu/docker/abc/cpu.cfs_period_us", "10000\n");
  write("cgroup/cpuacct,cpu/docker/abc/cpu.stat",
        "nr_periods 9\nnr_throttled 4\nthrottled_time 1\n");
  const MachineCpu machine = read();
  ASSERT_TRUE(machine.quota);
  EXPECT_DOUBLE_EQ(*machine.quota, 0.5);
  EXPECT_EQ(machine.throttled_periods, 4U);
}

TEST_F(MachineCpuTest, AGroupOfVersion1WithoutAQuota) {
  write("proc/self/cgroup", "1:cpu:/\n");
  write("cgroup/cpu/cpu.cfs_quota_us", "-1\n");
  write("cgroup/cpu/cpu.cfs_period_us", "100000\n");
  EXPECT_FALSE(read().quota);
}

}  // namespace
}  // namespace topogeo::support
