#include "topogeo/scan/carmen_log_check.hpp"

#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>

#include "topogeo/scan/carmen_log_writer.hpp"

#include "log_files.hpp"

namespace topogeo::scan {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// A FLASER line of three beams at this time and place.
std::string line(const std::string& time, const std::string& x = "0",
                 const std::string& ranges = "3 1 2 3") {
  return "FLASER " + ranges + " 0 0 0 " + x + " 0 0 " + time + " host " + time + "\n";
}

class LogCheckTest : public LogFiles {
 protected:
  LogCheck check(const std::string& text, const LogCheckOptions& options = {}) {
    std::ofstream(path("log.clf"), std::ios::binary) << text;
    return check_carmen_log(path("log.clf"), options);
  }
  /// The only fault in the log.
  static LogFinding only(const LogCheck& check) {
    EXPECT_EQ(check.faults(), 1U);
    if (check.findings.size() != 1) return {};
    return check.findings.front();
  }
};

TEST_F(LogCheckTest, ACleanLogIsSummedUp) {
  const LogCheck result = check("# comment\nODOM 0 0 0 0 0 0 1 h 1\nPARAM x y\n" +
                                line("10.0", "0") + line("10.2", "0.1") + line("10.5", "0.3"));
  EXPECT_EQ(result.faults(), 0U);
  EXPECT_EQ(result.lines, 6U);
  EXPECT_EQ(result.scans, 3U);
  EXPECT_EQ(result.comments, 1U);
  EXPECT_EQ(result.odometry_lines, 1U);
  EXPECT_EQ(result.other_lines, 1U);
  EXPECT_EQ(result.beams, 3U);
  EXPECT_EQ(result.first_ns, 10'000'000'000);
  EXPECT_EQ(result.last_ns, 10'500'000'000);
  EXPECT_NEAR(result.longest_period_s, 0.3, 1e-9);
  EXPECT_NEAR(result.path_m, 0.3, 1e-9);
}

TEST_F(LogCheckTest, EachFaultIsFoundWithItsLine) {
  struct Case {
    std::string third;  // line 3
    LogFault fault;
    std::string text;
  };
  const std::string long_gap = line("14.0");
  const std::vector<Case> cases = {
      {long_gap, LogFault::kGap, "3.600 s"},
      {line("10.1"), LogFault::kReversal, "0.300000 s before"},
      {line("10.4"), LogFault::kDuplicate, "same readings"},
      {line("10.4", "0", "3 1 2 2"), LogFault::kDuplicate, "other readings"},
      {line("10.5", "9"), LogFault::kJump, "9.000 m"},
      {line("10.5", "0", "3 -1 2 3"), LogFault::kNumber, "range 0"},
      {line("10.5", "nan"), LogFault::kNumber, "odometry x"},
      {line("-10.5"), LogFault::kStamp, "time stamp"},
      {"FLASER 3 1 2 3 0 0 0 0 0\n", LogFault::kTruncated, "fields"},
      {"FLASER 3 1 2\n", LogFault::kTruncated, "fields"},
      {"FLASER\n", LogFault::kTruncated, "number of ranges"},
      {line("10.5", "0", "3 1 2 3 4"), LogFault::kFields, "fields"},
      {line("10.5", "0", "3 1 two 3"), LogFault::kFields, "range 1"},
      {std::string("FLASER 3 1 \x01 3\n"), LogFault::kText, "binary"},
  };
  LogCheckOptions options;
  options.longest_gap_s = 2.0;
  for (const Case& c : cases) {
    const LogFinding finding = only(check(line("10.0") + line("10.4") + c.third, options));
    EXPECT_EQ(finding.fault, c.fault) << c.third << describe(finding.fault);
    EXPECT_EQ(finding.line, 3U) << c.third;
    EXPECT_THAT(finding.text, HasSubstr(c.text)) << c.third;
  }
}

TEST_F(LogCheckTest, ChangeOfBeamsIsFoundBothWays) {
  const LogCheck result =
      check(line("1.0") + line("1.1", "0", "4 1 2 3 4") + line("1.2") + line("1.3"));
  EXPECT_EQ(result.count(LogFault::kGeometry), 2U);
  EXPECT_EQ(result.faults(), 2U);
  EXPECT_EQ(result.beams, 3U);
  EXPECT_THAT(result.findings.front().text, AllOf(HasSubstr("4 beams"), HasSubstr("3 beams")));
}

TEST_F(LogCheckTest, StuckLaserIsFoundOnceAndEmptyViewIsNone) {
  std::string stuck;
  std::string empty;
  for (int i = 0; i < 12; ++i) {
    const std::string time = "1." + std::to_string(100 + i);
    stuck += line(time, "0", "12 1 2 3 4 5 6 7 8 9 1 2 3");
    empty += line(time, "0", "12 1 0 0 0 0 0 0 0 0 0 0 0");
  }
  LogCheckOptions options;
  options.stuck_scans = 10;
  EXPECT_EQ(only(check(stuck, options)).line, 10U);
  EXPECT_EQ(check(empty, options).faults(), 0U);
  options.stuck_scans = 13;
  EXPECT_EQ(check(stuck, options).faults(), 0U);
}

TEST_F(LogCheckTest, GapsAreMeasuredByTheLogItself) {
  // A scan every 3 s: up to 15 s are no gap, relative to that period.
  const std::string slow = line("1") + line("4") + line("7") + line("10");
  EXPECT_EQ(check(slow + line("24")).faults(), 0U);
  EXPECT_EQ(only(check(slow + line("26") + line("29"))).line, 5U);
  LogCheckOptions options;
  options.longest_gap_s = 2.5;
  EXPECT_EQ(check(slow, options).count(LogFault::kGap), 3U);
  // Findings are sorted by line, in whichever order they are found.
  const LogCheck mixed = check(slow + line("26") + "FLASER 3 1\n");
  ASSERT_EQ(mixed.findings.size(), 2U);
  EXPECT_EQ(mixed.findings[0].fault, LogFault::kGap);
  EXPECT_EQ(mixed.findings[1].fault, LogFault::kTruncated);
}

TEST_F(LogCheckTest, AllFaultsAreCountedAndSomeAreKept) {
  std::string text = line("1.0");
  for (int i = 0; i < 50; ++i) text += "FLASER 3 1\n";
  LogCheckOptions options;
  options.findings = 7;
  const LogCheck result = check(text, options);
  EXPECT_EQ(result.count(LogFault::kTruncated), 50U);
  EXPECT_EQ(result.findings.size(), 7U);
}

TEST_F(LogCheckTest, CutOffCompressionIsAFault) {
  CarmenLogWriter writer(path("whole.clf.gz"));
  Scan scan;
  scan.angle_min_rad = -1.0;
  scan.angle_step_rad = 0.01;
  for (int i = 0; i < 300; ++i) {
    scan.stamp_ns = 1'000'000'000 + 100'000'000LL * i;
    scan.ranges_m.assign(200, 1.0F + 0.01F * static_cast<float>(i * i % 97));
    writer.write(scan);
  }
  writer.close();
  const std::string whole = content_of(path("whole.clf.gz"));
  std::ofstream(path("cut.clf.gz"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  EXPECT_EQ(check_carmen_log(path("whole.clf.gz")).faults(), 0U);
  const LogCheck cut = check_carmen_log(path("cut.clf.gz"));
  EXPECT_EQ(cut.count(LogFault::kCompression), 1U);
  EXPECT_LT(cut.scans, 300U);
}

TEST_F(LogCheckTest, WhatIsNoLogIsAnError) {
  EXPECT_THROW(check_carmen_log(path("missing.clf")), std::runtime_error);
  EXPECT_THROW(check(""), std::runtime_error);
  EXPECT_THROW(check("# nothing but a comment\n"), std::runtime_error);
  LogCheckOptions options;
  options.longest_gap_s = -1.0;
  EXPECT_THROW(check(line("1.0"), options), std::invalid_argument);
  options = {};
  options.stuck_scans = 1;
  EXPECT_THROW(check(line("1.0"), options), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::scan
