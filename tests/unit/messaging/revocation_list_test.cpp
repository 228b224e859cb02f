#include "revocation_list.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <unistd.h>

namespace topogeo::messaging {
namespace {

class RevocationListTest : public ::testing::Test {
 protected:
  RevocationListTest() { std::filesystem::create_directories(folder_); }
  RevocationListTest(const RevocationListTest&) = delete;
  RevocationListTest& operator=(const RevocationListTest&) = delete;
  ~RevocationListTest() override { std::filesystem::remove_all(folder_); }

  void write(int at_s) const {
    std::ofstream(folder_ / "revoked.pem") << "list";
    std::filesystem::last_write_time(folder_ / "revoked.pem",
                                     std::filesystem::file_time_type(std::chrono::seconds(at_s)));
  }

  std::filesystem::path folder_ = std::filesystem::temp_directory_path() /
                                  ("topogeo-revocations-" + std::to_string(::getpid()));
};

TEST_F(RevocationListTest, ReportsEachChangeOnce) {
  write(100);
  RevocationList list(folder_);
  EXPECT_FALSE(list.take_change());
  write(200);
  EXPECT_TRUE(list.take_change());
  EXPECT_FALSE(list.take_change());
  // A copied file may be older than the file that it replaces.
  write(150);
  EXPECT_TRUE(list.take_change());
}

TEST_F(RevocationListTest, NoticesTheFirstListAndThatItIsGone) {
  RevocationList list(folder_);
  EXPECT_FALSE(list.take_change());
  write(100);
  EXPECT_TRUE(list.take_change());
  std::filesystem::remove(folder_ / "revoked.pem");
  EXPECT_TRUE(list.take_change());
  EXPECT_FALSE(RevocationList().take_change());
}

}  // namespace
}  // namespace topogeo::messaging
