#include "sensor_gateway/odometry_memory.hpp"

#include <fstream>

#include <gtest/gtest.h>

namespace topogeo::sensor_gateway {
namespace {

namespace fs = std::filesystem;

class OdometryMemoryTest : public testing::Test {
 protected:
  OdometryMemoryTest() {
    fs::remove(path_);
    odometry_.state.report.mask = 0x000A0A7A;
    for (std::uint32_t i = 0; i < devices::kMcpFields; ++i) {
      odometry_.state.report.fields.at(i) = 0xF0000000U + i;
    }
    odometry_.state.arrival_ns = 123'456'789'012'345;
    odometry_.state.T_odom_robot = {1.25, -3.5, 2.75};
    odometry_.epoch = 0xfedcba9876543210ULL;
    odometry_.next_sequence = 4711;
    odometry_.last_stamp_ns = 1'700'000'000'000'000'001;
  }
  ~OdometryMemoryTest() override { fs::remove(path_); }

  const fs::path path_ = fs::path(testing::TempDir()) / "topogeo_odometry_memory_test";
  RememberedOdometry odometry_;
};

TEST_F(OdometryMemoryTest, GivesAnotherProcessTheLastState) {
  EXPECT_FALSE(OdometryMemory(path_).load());
  OdometryMemory(path_).store({});
  OdometryMemory(path_).store(odometry_);
  const auto read = OdometryMemory(path_).load();
  ASSERT_TRUE(read);
  EXPECT_EQ(read->state.report, odometry_.state.report);
  EXPECT_EQ(read->state.arrival_ns, odometry_.state.arrival_ns);
  EXPECT_EQ(read->state.T_odom_robot, odometry_.state.T_odom_robot);
  EXPECT_EQ(read->epoch, odometry_.epoch);
  EXPECT_EQ(read->next_sequence, odometry_.next_sequence);
  EXPECT_EQ(read->last_stamp_ns, odometry_.last_stamp_ns);
}

TEST_F(OdometryMemoryTest, NothingIsReadOfAFileThatIsDamagedOrCutShort) {
  OdometryMemory(path_).store(odometry_);
  const auto size = fs::file_size(path_);
  for (std::uintmax_t at = 0; at < size; at += 5) {
    OdometryMemory(path_).store(odometry_);
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekg(static_cast<std::streamoff>(at));
    const char byte = static_cast<char>(file.get() ^ 0x10);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(byte);
    file.close();
    EXPECT_FALSE(OdometryMemory(path_).load()) << at;
  }
  OdometryMemory(path_).store(odometry_);
  fs::resize_file(path_, size - 1);
  EXPECT_FALSE(OdometryMemory(path_).load());
}

TEST_F(OdometryMemoryTest, WithoutAFileNothingIsKeptAndAWrongOneIsNamed) {
  const OdometryMemory none{fs::path()};
  none.store(odometry_);
  EXPECT_FALSE(none.load());
  EXPECT_THROW(OdometryMemory("/nowhere/at/all"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
