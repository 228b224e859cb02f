// Every fault a thousand times: no scan that was not measured, recovery in time, every drop
// counted.
#include "pls_faults.hpp"

#include <string>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

class PlsFaults : public ::testing::TestWithParam<PlsFaultTest> {};

TEST_P(PlsFaults, AThousandTimesAtFullRate) {
  const PlsFaultResult result = run_pls_fault(GetParam(), 500'000, 1000, 1);
  EXPECT_EQ(result.times, 1000U);
  EXPECT_GT(result.scans, 1000U);
  EXPECT_EQ(result.wrong_scans, 0U);
  EXPECT_EQ(result.uncounted, 0U);
  EXPECT_EQ(result.late, 0U) << "worst " << result.worst_recovery_ns << " ns, allowed "
                             << GetParam().allowed_ns << " ns";
}

std::string name_of_pls_fault(const ::testing::TestParamInfo<PlsFaultTest>& info) {
  std::string name;
  for (const char c : info.param.name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name.push_back(c);
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, PlsFaults, ::testing::ValuesIn(pls_fault_tests(500'000)),
                         name_of_pls_fault);

TEST(PlsFaults, OfTheLineAtLowerRates) {
  for (const std::uint32_t baud : {9600U, 38400U}) {
    for (const PlsFaultTest& test : pls_fault_tests(baud)) {
      // The power-on rate needs no switch that could fail.
      if (baud == 9600 && test.counted_as == "switches_not_followed") continue;
      const PlsFaultResult result = run_pls_fault(test, baud, 20, 2);
      EXPECT_EQ(result.wrong_scans, 0U) << test.name;
      EXPECT_EQ(result.uncounted, 0U) << test.name;
      EXPECT_LE(result.worst_recovery_ns, 20'000'000'000) << test.name << " at " << baud;
    }
  }
}

}  // namespace
}  // namespace topogeo::devices
