#include <random>

#include <gmock/gmock.h>

#include "log_files.hpp"

namespace topogeo::scan {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

// A log with a bad second line: the first and third are still read, the bad one is explained.
struct BadLine {
  const char* name;
  std::string line;
  SkipReason reason;
  const char* message;
};

// Printed by the test runner instead of the bytes.
std::ostream& operator<<(std::ostream& out, const BadLine& tested) {
  return out << tested.name;
}

class BadLines : public LogFiles, public ::testing::WithParamInterface<BadLine> {};

TEST_P(BadLines, IsSkippedCountedAndExplained) {
  CarmenLogReader reader(plain(flaser("1.0") + GetParam().line + flaser("3.0")));
  const auto scans = read_all(reader);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].stamp_ns, 1'000'000'000);
  EXPECT_EQ(scans[1].stamp_ns, 3'000'000'000);
  EXPECT_EQ(scans[1].sequence, 1U);
  const auto& s = reader.statistics();
  EXPECT_EQ(s.skipped_total(), 1U);
  EXPECT_EQ(s.skipped_for(GetParam().reason), 1U) << s.summary();
  ASSERT_EQ(s.messages.size(), 1U);
  EXPECT_THAT(s.messages[0], AllOf(HasSubstr("a.clf:2: expected "), HasSubstr(", got "),
                                   HasSubstr(GetParam().message)));
  EXPECT_EQ(s.summary(), "2 scans; skipped 1: 1 " + std::string(describe(GetParam().reason)));
}

INSTANTIATE_TEST_SUITE_P(
    Carmen, BadLines,
    ::testing::Values(
        BadLine{"negative", flaser("2.0", "1 2 3 -0.01"), SkipReason::kRange, "'-0.01'"},
        BadLine{"too_few", flaser("2.0", "1 2 3"), SkipReason::kFields, "15 fields"},
        BadLine{"too_many", flaser("2.0", "1 2 3 4 5"), SkipReason::kFields, "got 16"},
        BadLine{"word", flaser("2.0", "1 2 x3 4"), SkipReason::kFields, "'x3'"},
        BadLine{"trailing", flaser("2.0", "1 2 3m 4"), SkipReason::kFields, "'3m'"},
        BadLine{"huge", flaser("2.0", "1 2 1e99 4"), SkipReason::kFields, "'1e99'"},
        BadLine{"no_count", "FLASER\n", SkipReason::kFields, "end of the line"},
        BadLine{"zero_beams", "FLASER 0 9 9 9 1 1 1 2.0 h 2.0\n", SkipReason::kFields, "'0'"},
        BadLine{"huge_count", "FLASER 99999999999999999999 1 2\n", SkipReason::kFields,
                "[2, 2048]"},
        BadLine{"negative_count", "FLASER -4 1 2\n", SkipReason::kFields, "'-4'"},
        BadLine{"cut_off", flaser("2.0").substr(0, 30) + "\n", SkipReason::kFields, "15 fields"},
        BadLine{"pose_nan", "FLASER 4 1 2 3 4 9 9 9 nan 0 0 2.0 h 2.0\n", SkipReason::kPose, "x"},
        BadLine{"pose_far", "FLASER 4 1 2 3 4 9 9 9 0 1e9 0 2.0 h 2.0\n", SkipReason::kPose, "1e9"},
        BadLine{"stamp_word", "FLASER 4 1 2 3 4 9 9 9 0 0 0 2.x h 2.0\n", SkipReason::kStamp,
                "2.x"},
        BadLine{"stamp_minus", "FLASER 4 1 2 3 4 9 9 9 0 0 0 -2.0 h 2.0\n", SkipReason::kStamp,
                "-2"},
        BadLine{"stamp_nan", "FLASER 4 1 2 3 4 9 9 9 0 0 0 nan h 2.0\n", SkipReason::kStamp, "nan"},
        BadLine{"stamp_point", "FLASER 4 1 2 3 4 9 9 9 0 0 0 . h 2.0\n", SkipReason::kStamp, "'.'"},
        BadLine{"time_back", flaser("0.5"), SkipReason::kTime, "after 1.000000000, got 0.5"},
        BadLine{"time_same", flaser("1.0"), SkipReason::kTime, "after 1.000000000"},
        BadLine{"time_ahead", flaser("99999.0"), SkipReason::kTime, "next scan"},
        BadLine{"beam_count", flaser("2.0", "1 2 3 4 5", 5), SkipReason::kGeometry, "4 beams"},
        BadLine{
            "robotlaser_step",
            "ROBOTLASER1 4 -1.5 2.0 0.5 8.0 0.01 0 4 1 2 3 4 0 5 5 5 1 2 3 0 0 0 0 0 2.0 h 2.0\n",
            SkipReason::kGeometry, "first scan"},
        BadLine{"robotlaser_tiny_step",
                "ROBOTLASER1 4 -1.5 2.0 1e-300 8.0 0.01 0 4 1 2 3 4 0 5 5 5 1 2 3 0 0 0 0 0 2.0 h "
                "2.0\n",
                SkipReason::kGeometry, "0.00001"},
        BadLine{
            "robotlaser_nan_max",
            "ROBOTLASER1 4 -1.5 2.0 0.5 nan 0.01 0 4 1 2 3 4 0 5 5 5 1 2 3 0 0 0 0 0 2.0 h 2.0\n",
            SkipReason::kRange, "maximum range"},
        BadLine{"robotlaser_short", "ROBOTLASER1 4 -1.5 2.0 0.5 8.0 0.01 0 4 1 2 3 4\n",
                SkipReason::kFields, "remission"},
        BadLine{"binary", std::string("\x01\x02\x00 junk\n", 9), SkipReason::kText, "binary"},
        BadLine{"endless", std::string(3U << 20U, 'x') + "\n", SkipReason::kText, "1 MiB"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST_F(LogFiles, RangesThatAreNoNumberAreNoEcho) {
  CarmenLogReader reader(plain(flaser("1.0", "1 nan 3 4") + flaser("2.0", "-nan inf -inf 4")));
  const auto scans = read_all(reader);
  ASSERT_EQ(scans.size(), 2U);
  constexpr float kNone = Scan::kNoReturn;
  EXPECT_THAT(scans[0].ranges_m, ::testing::ElementsAre(1.0F, kNone, 3.0F, 4.0F));
  EXPECT_THAT(scans[1].ranges_m, ::testing::ElementsAre(kNone, kNone, kNone, 4.0F));
  EXPECT_EQ(reader.statistics().skipped_total(), 0U);
}

TEST_F(LogFiles, UnusableFilesAreErrorsThatNameTheFileAndTheReason) {
  EXPECT_THAT(open_error(path("none.clf")),
              AllOf(HasSubstr("none.clf"), HasSubstr("No such file")));
  EXPECT_THAT(open_error(path("")), HasSubstr("directory"));
  EXPECT_THAT(open_error(plain("")), AllOf(HasSubstr("a.clf"), HasSubstr("an empty file")));
  EXPECT_THAT(open_error(gzip("")), HasSubstr("an empty file"));
  EXPECT_THAT(open_error(plain("# only\nODOM 1 2 3 0 0 0 1 h 1\n")),
              AllOf(HasSubstr("FLASER"), HasSubstr("2 lines without one")));
  EXPECT_THAT(open_error(plain(std::string("\x7f"
                                           "ELF\x00\x01\n\x02\x03",
                                           9))),
              HasSubstr("binary data"));
  EXPECT_THAT(open_error(plain(std::string(5U << 20U, '\0'))), HasSubstr("binary data"));
  const std::string utf16(
      "\xFF\xFE"
      "F\0L\0A\0S\0E\0R\0 \0001\0\n\0",
      20);
  EXPECT_THAT(open_error(plain(utf16)),
              AllOf(HasSubstr("text in UTF-16"), HasSubstr("`iconv -f UTF-16 -t UTF-8 /")));
  EXPECT_THAT(open_error(plain(flaser("1.0", "1 -2 3 4") + flaser("2.0", "1 2 3 -4"))),
              AllOf(HasSubstr("none of 2 laser lines"), HasSubstr("a.clf:1: expected")));
  EXPECT_THROW(count_scans(path("none.clf")), std::runtime_error);
}

TEST_F(LogFiles, ChangedBeamCountIsSkippedUntilTheFirstOneReturns) {
  CarmenLogReader reader(
      plain(flaser("1.0") + flaser("2.0", "1 2", 2) + flaser("3.0", "1 2 3", 3) + flaser("4.0")));
  EXPECT_EQ(read_all(reader).size(), 2U);
  EXPECT_EQ(reader.statistics().skipped_for(SkipReason::kGeometry), 2U);
}

TEST_F(LogFiles, AWrongFirstStampDoesNotLoseTheRest) {
  CarmenLogReader reader(plain(flaser("9999999.0") + flaser("1.0") + flaser("2.0")));
  const auto scans = read_all(reader);
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0].stamp_ns, 1'000'000'000);
  EXPECT_EQ(reader.statistics().skipped_for(SkipReason::kTime), 1U);
}

TEST_F(LogFiles, ALongPauseIsNoError) {
  CarmenLogReader reader(plain(flaser("1.0") + flaser("90000.0") + flaser("90001.0")));
  EXPECT_EQ(read_all(reader).size(), 3U);
  EXPECT_EQ(reader.statistics().skipped_total(), 0U);
}

TEST_F(LogFiles, OtherFilesAreRefusedWithWhatTheyHold) {
  EXPECT_THAT(open_error(plain("# log\nODOM 1 2 3\nRAWLASER1 0 -1.57\nODOM 2 2 3\nSYNC 1\n")),
              testing::HasSubstr("got 5 lines without one; they begin with 'ODOM', 'RAWLASER1'; "
                                 "recordings of ROS (.bag, .db3, .mcap) are read, too"));
  EXPECT_THAT(open_error(plain("time,x,y,theta,ranges_of_all_beams\n1,2,3,4,5\n")),
              testing::HasSubstr("they begin with 'time,x,y,theta,ranges_of', '1,2,3,4,5';"));
}

TEST_F(LogFiles, EachReasonHasOneMessageButAllSkipsAreCounted) {
  std::string text = flaser("1.0");
  for (int i = 0; i < 100; ++i) text += flaser("1.0");
  for (int i = 0; i < 20; ++i) text += flaser("2.0", "1 2", 2);
  CarmenLogReader reader(plain(text));
  EXPECT_EQ(read_all(reader).size(), 1U);
  const CarmenLogStatistics& statistics = reader.statistics();
  EXPECT_EQ(statistics.summary(),
            "1 scans; skipped 120: 100 time not increasing, 20 other beam geometry");
  EXPECT_THAT(statistics.messages,
              testing::ElementsAre(testing::HasSubstr(":2: "), testing::HasSubstr(":102: ")));
}

// Lines that compress badly, so that a cut leaves many whole ones.
std::string varied_log(int scans) {
  std::mt19937 random(7);
  std::string text;
  for (int i = 1; i <= scans; ++i) {
    std::ostringstream ranges;
    ranges << 1;
    for (int k = 1; k < 180; ++k) ranges << ' ' << 1 + random() % 3000 << "e-2";
    text += flaser(std::to_string(i) + ".0", ranges.str(), 180, "1");
  }
  return text;
}

TEST_F(LogFiles, TruncatedGzipIsUsedUpToTheCut) {
  const std::string all = content_of(gzip(varied_log(400)));
  CarmenLogReader reader(plain(all.substr(0, all.size() / 2), "cut.clf.gz"));
  const auto scans = read_all(reader);
  EXPECT_GT(scans.size(), 150U);
  EXPECT_LT(scans.size(), 250U);
  const auto& s = reader.statistics();
  EXPECT_EQ(s.skipped_for(SkipReason::kTruncated), 1U);
  EXPECT_EQ(s.skipped_total(), 1U) << "the fragment of a line at the cut is no bad line of its own";
  ASSERT_EQ(s.messages.size(), 1U);
  EXPECT_THAT(s.messages[0], AllOf(HasSubstr("cut.clf.gz:"), HasSubstr("compressed data")));
}

TEST_F(LogFiles, DamagedGzipIsUsedUpToTheDamage) {
  std::string all = content_of(gzip(varied_log(1000)));
  for (std::size_t i = all.size() / 2; i < all.size() / 2 + 64; ++i) all[i] = '\xff';
  CarmenLogReader reader(plain(all, "bad.clf.gz"));
  EXPECT_GT(read_all(reader).size(), 100U);
  EXPECT_GE(reader.statistics().skipped_total(), 1U);
}

TEST_F(LogFiles, GzipCutBeforeTheFirstScanIsAnError) {
  const std::string all = content_of(gzip(varied_log(10)));
  for (const std::size_t size : {std::size_t{3}, std::size_t{12}, std::size_t{60}}) {
    EXPECT_THAT(open_error(plain(all.substr(0, size), "cut.clf.gz")), HasSubstr("cut.clf.gz: "))
        << size;
  }
}

TEST_F(LogFiles, TruncatedPlainLogLosesItsLastLineOnly) {
  const std::string text = flaser("1.0") + flaser("2.0") + flaser("3.0");
  CarmenLogReader reader(plain(text.substr(0, text.size() - 20)));
  EXPECT_EQ(read_all(reader).size(), 2U);
  EXPECT_EQ(reader.statistics().skipped_for(SkipReason::kFields), 1U);
}

void expect_valid(const std::vector<Scan>& scans) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    ASSERT_EQ(scans[i].sequence, i);
    ASSERT_EQ(scans[i].ranges_m.size(), scans[0].ranges_m.size());
    ASSERT_EQ(scans[i].angle_step_rad, scans[0].angle_step_rad);
    for (const float r : scans[i].ranges_m) ASSERT_TRUE(r >= 0.0F && r < 49.9F) << r;
    ASSERT_LE(std::fabs(scans[i].T_odom_robot.theta_rad), 3.1415927);
    ASSERT_LE(std::fabs(scans[i].T_odom_robot.x_m), 1e6);
    if (i == 0) continue;
    ASSERT_GT(scans[i].stamp_ns, scans[i - 1].stamp_ns);
  }
}

// Random changes, deletions, duplications and insertions of bytes: an error that names the file, or
// valid scans and consistent counts.
TEST_F(LogFiles, RandomDamageNeverGivesAnInvalidScan) {
  std::mt19937 random(11);
  std::string good;
  for (int i = 1; i <= 9; ++i) {
    good += flaser(std::to_string(i) + ".25");
    good += "ODOM 1 2 3 0 0 0 1 h 1\n";
  }
  std::string alphabet = "0123456789.-+eE nainf\n\t\r#FLASER\xff";
  alphabet.push_back(0);
  for (int round = 0; round < 1000; ++round) {
    std::string text = good;
    const auto damages = 1 + random() % 5;
    for (unsigned k = 0; k < damages && !text.empty(); ++k) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = alphabet[random() % alphabet.size()];
          break;
        case 1:
          text.erase(at, 1 + random() % 20);
          break;
        case 2:
          text.insert(at, text.substr(at, random() % 40));
          break;
        default:
          text.insert(at, 1, alphabet[random() % alphabet.size()]);
      }
    }
    const auto log = plain(text);
    try {
      CarmenLogReader reader(log);
      const auto scans = read_all(reader);
      ASSERT_FALSE(scans.empty());
      ASSERT_NO_FATAL_FAILURE(expect_valid(scans)) << text;
      const auto& s = reader.statistics();
      ASSERT_EQ(s.lines, s.laser_lines + s.comments + s.odometry_lines + s.other_lines +
                             s.skipped_for(SkipReason::kText));
      ASSERT_EQ(s.laser_lines, s.scans + s.skipped_total() - s.skipped_for(SkipReason::kText));
    } catch (const std::runtime_error& error) {
      ASSERT_THAT(error.what(), HasSubstr("a.clf: "));
    }
  }
}

TEST_F(LogFiles, RandomDamageOfGzipNeverGivesAnInvalidScan) {
  std::mt19937 random(13);
  const std::string good = content_of(gzip(varied_log(20)));
  for (int round = 0; round < 300; ++round) {
    std::string bytes = good;
    for (int k = 0; k < 3; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    const auto log = plain(bytes, "b.clf.gz");
    try {
      CarmenLogReader reader(log);
      ASSERT_NO_FATAL_FAILURE(expect_valid(read_all(reader)));
    } catch (const std::runtime_error& error) {
      ASSERT_THAT(error.what(), HasSubstr("b.clf.gz: "));
    }
  }
}

}  // namespace
}  // namespace topogeo::scan
