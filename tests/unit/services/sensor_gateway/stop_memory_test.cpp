#include "sensor_gateway/stop_memory.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "full_disk.hpp"

namespace topogeo::sensor_gateway {
namespace {

namespace fs = std::filesystem;

class StopMemoryTest : public testing::Test {
 protected:
  StopMemoryTest() { fs::remove(path_); }
  ~StopMemoryTest() override { fs::remove(path_); }

  const fs::path path_ = fs::path(testing::TempDir()) / "topogeo_stop_memory_test";
};

TEST_F(StopMemoryTest, GivesAnotherProcessTheStopsThatHold) {
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, false}));
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, false}));
  EXPECT_TRUE(StopMemory(path_).store({true, false}));
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{true, false}));
  EXPECT_TRUE(StopMemory(path_).store({false, true}));
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, true}));
  EXPECT_TRUE(StopMemory(path_).store({false, false}));
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, false}));
  EXPECT_FALSE(StopMemory(path_).damaged());
}

TEST_F(StopMemoryTest, ADamagedFileHalts) {
  EXPECT_TRUE(StopMemory(path_).store({true, false}));
  const auto size = fs::file_size(path_);
  fs::resize_file(path_, size - 1);
  const StopMemory memory(path_);
  EXPECT_TRUE(memory.damaged());
  EXPECT_EQ(memory.held(), (devices::HeldStops{false, true}));
  // The stop survives another start, too.
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, true}));
}

// A disk that refuses the stop must not let the next gateway drive.
TEST_F(StopMemoryTest, AStopThatCannotBeWrittenHaltsTheNextGateway) {
  StopMemory memory(path_);
  {
    const test::FullDisk full(8);
    EXPECT_FALSE(memory.store({true, false}));
    EXPECT_FALSE(memory.store({true, false})) << "tried again";
  }
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{false, true}));
  EXPECT_TRUE(memory.store({true, false}));
  EXPECT_EQ(StopMemory(path_).held(), (devices::HeldStops{true, false}));
}

TEST_F(StopMemoryTest, WithoutAFileNothingIsKept) {
  StopMemory none{fs::path()};
  EXPECT_TRUE(none.store({true, true}));
  EXPECT_EQ(StopMemory(fs::path()).held(), (devices::HeldStops{false, false}));
  EXPECT_THROW(StopMemory("/nowhere/at/all"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::sensor_gateway
