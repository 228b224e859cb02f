// Every fault of the base a thousand times: no wrong odometry, recovery in time, every drop
// counted, the robot at rest whenever it must be.
#include "base_faults.hpp"

#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

constexpr std::array kLines{
    BaseFaultLine{BaseDialect::kAscii, 9600}, BaseFaultLine{BaseDialect::kAscii, 38400},
    BaseFaultLine{BaseDialect::kBinary, 9600}, BaseFaultLine{BaseDialect::kBinary, 38400}};

void expect_no_harm(const BaseFaultTest& test, const BaseFaultLine& line, std::size_t times) {
  SCOPED_TRACE((line.dialect == BaseDialect::kAscii ? "ascii " : "binary ") +
               std::to_string(line.baud) + " " + test.name);
  const BaseFaultResult result = run_base_fault(test, line, times, line.baud);
  EXPECT_EQ(result.times, times);
  EXPECT_GT(result.odometries, times);
  EXPECT_EQ(result.wrong, 0U) << "worst " << result.worst_m << " m";
  EXPECT_EQ(result.uncounted, 0U);
  EXPECT_EQ(result.unsafe, 0U);
  EXPECT_EQ(result.late, 0U) << "worst " << result.worst_recovery_ns << " ns, allowed "
                             << test.allowed_ns << " ns";
}

using Case = std::pair<BaseFaultLine, BaseFaultTest>;

std::vector<Case> cases() {
  std::vector<Case> all;
  for (const BaseFaultLine& line : {kLines[0], kLines[2]}) {
    for (const BaseFaultTest& test : base_fault_tests(line)) all.emplace_back(line, test);
  }
  return all;
}

std::string name_of_base_fault(const testing::TestParamInfo<Case>& info) {
  std::string name = info.param.first.dialect == BaseDialect::kAscii ? "ascii" : "binary";
  for (const char c : info.param.second.name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name.push_back(c);
  }
  return name;
}

class BaseFaults : public testing::TestWithParam<Case> {};

TEST_P(BaseFaults, AThousandTimes) {
  expect_no_harm(GetParam().second, GetParam().first, 1000);
}

INSTANTIATE_TEST_SUITE_P(All, BaseFaults, testing::ValuesIn(cases()), name_of_base_fault);

TEST(BaseFaults, OnFasterLines) {
  for (const BaseFaultLine& line : {kLines[1], kLines[3]}) {
    for (const BaseFaultTest& test : base_fault_tests(line)) expect_no_harm(test, line, 50);
  }
}

}  // namespace
}  // namespace topogeo::devices
