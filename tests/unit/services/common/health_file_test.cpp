#include "topogeo/service/health_file.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "topogeo/support/process_stat.hpp"
#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::service {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

class HealthFileTest : public testing::Test {
 protected:
  [[nodiscard]] static std::string own_name(const std::string& service) {
    return service + "." + std::to_string(::getpid());
  }
  [[nodiscard]] std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      out.push_back(entry.path().filename().string());
    }
    return out;
  }
  [[nodiscard]] std::vector<std::string> lines(const std::string& name) const {
    std::ifstream file(folder_ / name);
    std::vector<std::string> out;
    for (std::string line; std::getline(file, line);) out.push_back(line);
    return out;
  }
  /// The state, the first line.
  [[nodiscard]] std::string content(const std::string& name) const {
    const std::vector<std::string> all = lines(name);
    return all.empty() ? "" : all.front();
  }
  void write(const std::string& name) const { std::ofstream(folder_ / name) << "running\n"; }

  support::TemporaryFolder temporary_{"health"};
  std::filesystem::path folder_ = temporary_.path() / "health";
};

TEST_F(HealthFileTest, HoldsTheStateWhileTheServiceLives) {
  {
    HealthFile file(folder_, "planner");
    EXPECT_THAT(names(), IsEmpty());
    file.update("waiting: no map has come yet");
    EXPECT_THAT(names(), UnorderedElementsAre(own_name("planner")));
    EXPECT_EQ(content(own_name("planner")), "waiting: no map has come yet");
    file.update("running");
    EXPECT_EQ(content(own_name("planner")), "running");
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(HealthFileTest, NothingIsWrittenTwiceWithinASecond) {
  using Clock = std::chrono::steady_clock;
  for (bool within = false; !within;) {  // again if the machine stood still meanwhile
    const auto start = Clock::now();
    HealthFile file(folder_, "planner");
    file.update("running");
    std::filesystem::remove(folder_ / own_name("planner"));
    file.update("running");
    const bool written = !names().empty();
    within = Clock::now() - start < std::chrono::seconds(1);
    EXPECT_FALSE(within && written);
  }
}

TEST_F(HealthFileTest, RemovesTheFilesOfItsDeadPredecessorsOnly) {
  const pid_t dead = ::fork();
  if (dead == 0) std::_Exit(0);
  ASSERT_EQ(::waitpid(dead, nullptr, 0), dead);
  std::filesystem::create_directory(folder_);
  const std::string left = "planner." + std::to_string(dead);
  const std::string of_another = "localizer." + std::to_string(dead);
  const std::string of_one_alive = "planner." + std::to_string(::getppid());
  for (const std::string& name : {left, of_another, of_one_alive, std::string("planner.txt")}) {
    write(name);
  }
  const HealthFile file(folder_, "planner");
  EXPECT_THAT(names(), UnorderedElementsAre(of_another, of_one_alive, "planner.txt"));
}

TEST_F(HealthFileTest, HasTheStartOfTheProcessBelowAStateOfOneLine) {
  HealthFile file(folder_, "planner");
  file.update("failed: line 1: expected a number\nmap: x");
  const auto start = support::process_start_ticks("/proc/self");
  ASSERT_TRUE(start);
  EXPECT_THAT(lines(own_name("planner")),
              ElementsAre("failed: line 1: expected a number map: x", std::to_string(*start)));
}

// A service that starts again in its container often gets the number of the one before.
TEST_F(HealthFileTest, RemovesTheFileOfADeadServiceWhoseNumberAnotherProcessHas) {
  std::filesystem::create_directory(folder_);
  std::ofstream(folder_ / own_name("planner")) << "running\n1\n";  // no process starts that early
  std::ofstream(folder_ / own_name("localizer")) << "running\n1\n";
  const HealthFile file(folder_, "planner");
  EXPECT_THAT(names(), UnorderedElementsAre(own_name("localizer")));
}

TEST_F(HealthFileTest, KeepsTheFileOfALivingService) {
  HealthFile living(folder_, "planner");
  living.update("running");
  const HealthFile next(folder_, "planner");
  EXPECT_THAT(names(), UnorderedElementsAre(own_name("planner")));
}

TEST_F(HealthFileTest, WithoutAFolderNothingIsWritten) {
  HealthFile file({}, "planner");
  file.update("running");
}

TEST_F(HealthFileTest, AServiceGoesOnWithoutAFolderThatCanBeWritten) {
  std::ofstream(folder_) << "no folder\n";
  HealthFile file(folder_, "planner");
  file.update("running");
  EXPECT_TRUE(std::filesystem::is_regular_file(folder_));
}

}  // namespace
}  // namespace topogeo::service
