#include "topogeo/support/process_stat.hpp"

#include <fstream>

#include <gtest/gtest.h>

#include "topogeo/support/temporary_folder.hpp"

namespace topogeo::support {
namespace {

TEST(ProcessStat, HasTheStartOfTheProcess) {
  const TemporaryFolder process("process-stat");
  // The name may look like the fields after it.
  std::ofstream(process.path() / "stat")
      << "71 (a) S 1) R 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 2222 23 24\n";
  EXPECT_EQ(process_start_ticks(process.path()), 2222U);
}

TEST(ProcessStat, HasNoStartOfAProcessThatHasEnded) {
  const TemporaryFolder process("process-stat");
  EXPECT_FALSE(process_start_ticks(process.path()));
  std::ofstream(process.path() / "stat") << "71 (planner) S 1 5 6\n";
  EXPECT_FALSE(process_start_ticks(process.path()));
}

TEST(ProcessStat, HasTheSameStartEachTime) {
  const auto start = process_start_ticks("/proc/self");
  ASSERT_TRUE(start);
  EXPECT_EQ(process_start_ticks("/proc/self"), start);
}

}  // namespace
}  // namespace topogeo::support
