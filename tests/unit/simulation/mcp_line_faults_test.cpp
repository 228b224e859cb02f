#include "topogeo/simulation/mcp_line_faults.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::simulation {
namespace {

const std::vector<std::uint8_t> kReport(24, 0x55);

TEST(McpLineFaults, LeavesReportsAsTheyAreUntilOneIsOrdered) {
  McpLineFaults faults(1);
  std::vector<std::uint8_t> report = kReport;
  faults.damage(report);
  EXPECT_EQ(report, kReport);
  EXPECT_FALSE(faults.silent());
}

TEST(McpLineFaults, CorruptsOneBitOfEachOfTheNextReports) {
  McpLineFaults faults(1);
  faults.corrupt(2);
  for (int i = 0; i < 3; ++i) {
    std::vector<std::uint8_t> report = kReport;
    faults.damage(report);
    int wrong_bits = 0;
    for (std::size_t b = 0; b < report.size(); ++b) {
      wrong_bits += std::popcount(static_cast<unsigned>(report[b] ^ kReport[b]));
    }
    EXPECT_EQ(wrong_bits, i < 2 ? 1 : 0) << i;
  }
}

TEST(McpLineFaults, TruncatedReportsLoseBytesAtTheirEnd) {
  McpLineFaults faults(1);
  for (int i = 0; i < 200; ++i) {
    faults.truncate(1);
    std::vector<std::uint8_t> report = kReport;
    faults.damage(report);
    EXPECT_GE(report.size(), 4U);
    EXPECT_LE(report.size(), kReport.size() - 12U);
  }
  faults.truncate(1);
  std::vector<std::uint8_t> one_byte{0x55};
  faults.damage(one_byte);
  EXPECT_TRUE(one_byte.empty());
}

TEST(McpLineFaults, ASeedGivesTheSameGarbage) {
  EXPECT_EQ(McpLineFaults(5).garbage(32), McpLineFaults(5).garbage(32));
  EXPECT_NE(McpLineFaults(5).garbage(32), McpLineFaults(6).garbage(32));
}

}  // namespace
}  // namespace topogeo::simulation
