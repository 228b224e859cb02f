#include "topogeo/support/file_lock.hpp"

#include <csignal>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/support/host.hpp"

#include "waiting.hpp"

namespace topogeo::support {
namespace {

using std::chrono::milliseconds;

class FileLockTest : public testing::Test {
 protected:
  ~FileLockTest() override { std::filesystem::remove(path_); }

  /// The error of a second lock; empty when it succeeds.
  std::string refusal() const {
    try {
      const FileLock second(path_);
      return {};
    } catch (const std::runtime_error& error) {
      return error.what();
    }
  }

  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("file_lock_test_" + std::to_string(::getpid()));
};

TEST_F(FileLockTest, OneHoldsItAtATime) {
  std::ofstream(path_) << "what a longer name of a holder before left behind, whoever it was\n";
  {
    const FileLock lock(path_);
    EXPECT_EQ(refusal(), path_.string() + ": held by process " + process_name());
  }
  EXPECT_EQ(refusal(), "");
  EXPECT_TRUE(std::filesystem::exists(path_));
}

TEST_F(FileLockTest, ADeadProcessHoldsNothing) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const std::optional<FileLock> lock(std::in_place, path_);
    static_cast<void>(::write(pipe[1], "x", 1));
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(pipe[0], &byte, 1), 1);
  // In a container, the number of its PID namespace follows.
  EXPECT_THAT(refusal(), testing::ContainsRegex("-" + std::to_string(child) + "([.][0-9]+)?$"));
  ::kill(child, SIGKILL);
  EXPECT_NO_THROW(FileLock(path_, test::hang_limit()));
  EXPECT_EQ(::waitpid(child, nullptr, 0), child);
}

TEST_F(FileLockTest, SaysWhyAFileCannotBeLocked) {
  EXPECT_THROW(FileLock(path_ / "none"), std::runtime_error);
}

}  // namespace
}  // namespace topogeo::support
