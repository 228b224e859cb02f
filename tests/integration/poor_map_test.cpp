// A log whose map is poor with the default settings is mapped again with others.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class PoorMapTest : public testing::Test {
 protected:
  /// Exit code of `topogeo map`.
  int map(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"map",         "--log", log_, "--out", scratch_ / "map",
                                   "--reference", truth_};
    words.insert(words.end(), more.begin(), more.end());
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out_ = program.out();
    err_ = program.err();
    return code;
  }

  Scratch scratch_;
  std::filesystem::path log_ = scratch_ / "log.clf.gz";
  std::filesystem::path truth_ = scratch_ / "truth.tum";
  std::string out_;
  std::string err_;
};

/// Drives through a world with a laser that sees only so far, ten scans a metre.
simulation::SimulationOptions short_sighted(double range_max_m, std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.1;
  options.beams.range_max_m = range_max_m;
  return options;
}

TEST_F(PoorMapTest, IsMadeAgainWithMoreStops) {
  write_log("room", log_, truth_, short_sighted(2.0, 3));
  ASSERT_EQ(map(), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("few stops match: mapping again with a stop each 0.5 m\n"));
  EXPECT_THAT(out_, HasSubstr("quality: good\n"));
  const std::string report = read_file(scratch_ / "map" / "report.json");
  EXPECT_NE(report.find("\"stop.distance_m\": \"0.5\""), std::string::npos);
}

TEST_F(PoorMapTest, KeepsTheStopsOfTheConfiguration) {
  write_log("room", log_, truth_, short_sighted(2.0, 3));
  std::ofstream(scratch_ / "stops.yaml") << "stop: {distance_m: 1.0}\n";
  ASSERT_EQ(map({"--config", scratch_ / "stops.yaml"}), 3) << err_;
  EXPECT_THAT(err_, Not(HasSubstr("mapping again")));
  EXPECT_THAT(out_, HasSubstr("quality: poor: "));
  EXPECT_THAT(out_, HasSubstr("try: more stops"));
}

TEST_F(PoorMapTest, StaysIfAnotherIsNoBetter) {
  write_log("rooms", log_, truth_, short_sighted(1.5, 2));
  ASSERT_EQ(map(), 3) << err_;
  EXPECT_THAT(err_, HasSubstr("the results are written, but the map is poor: "));
  EXPECT_THAT(err_, HasSubstr("mapping again with the measured noise\n"));
  EXPECT_THAT(err_, HasSubstr("mapping again with odometry from the scans\n"));
  EXPECT_THAT(err_, HasSubstr("the map is no better: the one before stays\n"));
  EXPECT_THAT(out_, HasSubstr("try: topogeo check-log"));
}

/// Behind a door such a laser sees nothing of the room before.
TEST_F(PoorMapTest, DoesNotEndAtADoor) {
  write_log("rooms", log_, truth_, short_sighted(3.0, 2));
  ASSERT_EQ(map(), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("log.clf.gz: 231 scans"));
  EXPECT_THAT(out_, HasSubstr("quality: good\n"));
}

}  // namespace
}  // namespace topogeo::test
