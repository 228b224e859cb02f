#include "topogeo/messaging/shared_memory.hpp"

#include <fstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "topogeo/support/file_descriptor.hpp"

namespace topogeo::messaging {
namespace {

namespace fs = std::filesystem;

class SharedMemory : public testing::Test {
 protected:
  SharedMemory() { fs::create_directory(folder_); }
  ~SharedMemory() override { fs::remove_all(folder_); }

  /// Makes a file and its lock, both of this age.
  void make(const std::string& name, std::chrono::seconds age = std::chrono::seconds(60)) {
    for (const std::string& file : {name, name + "_el"}) {
      std::ofstream(folder_ / file) << "x";
      fs::last_write_time(folder_ / file, fs::file_time_type::clock::now() - age);
    }
  }
  bool exists(const std::string& name) const {
    EXPECT_EQ(fs::exists(folder_ / name), fs::exists(folder_ / (name + "_el"))) << name;
    return fs::exists(folder_ / name);
  }

  fs::path folder_ =
      fs::path(testing::TempDir()) / ("shared_memory_test_" + std::to_string(::getpid()));
};

TEST_F(SharedMemory, TheSegmentsOfTheDeadAreRemovedAndNothingElse) {
  make("fastrtps_0123456789abcdef");
  make("fastrtps_1123456789abcdef");  // of a program that runs
  make("fastrtps_2123456789abcdef", std::chrono::seconds(1));
  make("fastrtps_port7410");
  make("fastrtps_0123456789abcdeg");
  make("other_0123456789abcdef");
  const support::FileDescriptor held(
      ::open((folder_ / "fastrtps_1123456789abcdef_el").c_str(), O_RDONLY));
  ASSERT_EQ(::flock(held.get(), LOCK_EX), 0);
  const std::vector<DeadSegment> dead = find_dead_segments(folder_);
  ASSERT_EQ(dead.size(), 1U);
  EXPECT_EQ(dead[0].file, folder_ / "fastrtps_0123456789abcdef");
  EXPECT_EQ(dead[0].bytes, 1U);
  EXPECT_EQ(remove_dead_segments(folder_), 1U);
  EXPECT_FALSE(exists("fastrtps_0123456789abcdef"));
  for (const char* name :
       {"fastrtps_1123456789abcdef", "fastrtps_2123456789abcdef", "fastrtps_port7410",
        "fastrtps_0123456789abcdeg", "other_0123456789abcdef"}) {
    EXPECT_TRUE(exists(name)) << name;
  }
  EXPECT_EQ(remove_dead_segments(folder_ / "none"), 0U);
}

}  // namespace
}  // namespace topogeo::messaging
