#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>

#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/logging.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::support {
namespace {

TEST(StageTimes, SumsUpEachStageInOrderOfFirstEntry) {
  StageTimes times;
  { const auto scope = times.measure("tracking"); }
  const double cpu_before_s = process_cpu_s();
  {
    const auto scope = times.measure("search");
    // Loops until the CPU time has passed, without assumptions about the machine's speed.
    while (process_cpu_s() < cpu_before_s + 0.01) continue;
  }
  { const auto scope = times.measure("tracking"); }
  ASSERT_EQ(times.stages().size(), 2U);
  EXPECT_EQ(times.stages()[0].stage, "tracking");
  EXPECT_EQ(times.stages()[1].stage, "search");
  EXPECT_GT(times.stages()[1].cpu_s, 0.0);
  EXPECT_GT(times.stages()[1].wall_s, 0.0);
  EXPECT_GE(times.stages()[0].wall_s, 0.0);
  EXPECT_GE(children_cpu_s(), 0.0);
}

TEST(Logging, SetsNameAndLevelOfTheDefaultLogger) {
  set_up_logging("localizer", "warning");
  EXPECT_EQ(spdlog::default_logger()->name(), "localizer");
  EXPECT_EQ(spdlog::default_logger()->level(), spdlog::level::warn);
  EXPECT_THROW(set_up_logging("localizer", "loud"), std::invalid_argument);
  EXPECT_EQ(spdlog::default_logger()->level(), spdlog::level::warn);
}

TEST(Logging, KeepsAStrangersTextInItsLine) {
  testing::internal::CaptureStderr();
  set_up_logging("localizer", "info");
  spdlog::warn("refused '{}'", "\x1B[31m\n12:00:00.000 info localizer: forged");
  spdlog::default_logger()->flush();
  const std::string log = testing::internal::GetCapturedStderr();
  EXPECT_NE(log.find("localizer: refused '?[31m?12:00:00.000 info localizer: forged'\n"),
            std::string::npos)
      << log;
  EXPECT_EQ(std::ranges::count(log, '\n'), 1);
}

TEST(Version, HasThreeNumbers) {
  EXPECT_EQ(std::count(kVersion.begin(), kVersion.end(), '.'), 2);
  EXPECT_GE(kVersion.size(), 5U);
}

}  // namespace
}  // namespace topogeo::support
