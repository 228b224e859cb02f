#include "sensor_gateway/laser_memory.hpp"

#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace topogeo::sensor_gateway {
namespace {

namespace fs = std::filesystem;
using devices::LineSettings;
using devices::Parity;

class LaserMemoryTest : public testing::Test {
 protected:
  LaserMemoryTest() { fs::remove(path_); }
  ~LaserMemoryTest() override { fs::remove(path_); }

  void write(const std::string& text) const { std::ofstream(path_) << text; }

  const fs::path path_ = fs::path(testing::TempDir()) / "topogeo_laser_memory_test";
};

TEST_F(LaserMemoryTest, GivesAnotherProcessTheLastLine) {
  EXPECT_FALSE(LaserMemory(path_).load());
  for (const LineSettings line :
       {LineSettings{9600, Parity::kNone}, LineSettings{500'000, Parity::kEven}}) {
    LaserMemory memory(path_);
    memory.store({38400, Parity::kEven});
    memory.store(line);
    EXPECT_EQ(LaserMemory(path_).load(), line);
  }
}

TEST_F(LaserMemoryTest, WritesOnlyWhatHasChanged) {
  LaserMemory memory(path_);
  memory.store({500'000, Parity::kEven});
  fs::remove(path_);
  memory.store({500'000, Parity::kEven});
  EXPECT_FALSE(fs::exists(path_));
}

TEST_F(LaserMemoryTest, NothingIsReadOfAFileThatIsNoneOfIts) {
  LaserMemory(path_).store({500'000, Parity::kEven});
  for (const char* text : {"", "500000", "500000 even", "500000 even\n\n", "500001 even\n",
                           "-9600 none\n", "9600 mark\n"}) {
    write(text);
    EXPECT_FALSE(LaserMemory(path_).load()) << text;
  }
}

TEST_F(LaserMemoryTest, WithoutAFileNothingIsKept) {
  LaserMemory memory{fs::path()};
  memory.store({9600, Parity::kNone});
  EXPECT_FALSE(memory.load());
}

TEST_F(LaserMemoryTest, AFileThatCannotBeWrittenIsNoError) {
  LaserMemory memory(path_ / "not" / "there");
  memory.store({9600, Parity::kNone});
  EXPECT_FALSE(memory.load());
}

}  // namespace
}  // namespace topogeo::sensor_gateway
