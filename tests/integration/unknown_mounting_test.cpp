// The mounting of a laser that a recording does not state is found from its scans.
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr const char* kFound = "topogeo: the laser's mounting is unknown; the scans show ";

/// A laser behind the centre of its robot that looks backwards.
class UnknownMountingTest : public testing::Test {
 protected:
  UnknownMountingTest() {
    simulation::SimulationOptions options;
    options.T_robot_laser = {-0.2, 0.0, std::numbers::pi};
    write_log("floor", log_, truth_, options, options.T_robot_laser);
  }

  int run(const std::vector<std::string>& words) {
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out_ = program.out();
    err_ = program.err();
    return code;
  }

  /// The log as a recording whose transforms state another laser, so that nothing states this one.
  void forget_mounting(const std::vector<std::string>& more = {}) {
    record(more);
    std::ifstream file(recording_, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const std::string frames = std::string("base_link") + std::string("\x05\0\0\0", 4) + "laser";
    const std::size_t at = bytes.find(frames);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, frames.size(), frames.substr(0, frames.size() - 1) + "x");
    std::ofstream(recording_, std::ios::binary) << bytes;
  }

  void record(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"convert", log_, recording_, "--compression", "none"};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(run(words), 0) << err_;
  }

  void map(const std::string& out, const std::vector<std::string>& more = {}, int code = 0) {
    std::vector<std::string> words{"map",          "--log",       recording_, "--out",
                                   scratch_ / out, "--reference", truth_};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(run(words), code) << err_;
  }

  /// RMS error of the corrected trajectory against the reference.
  [[nodiscard]] double rms_m() const {
    std::istringstream line(out_.substr(out_.find("  corrected")));
    std::string word;
    double value = 1e9;
    line >> word >> value;
    return value;
  }

  Scratch scratch_;
  std::filesystem::path log_ = scratch_ / "log.clf.gz";
  std::filesystem::path truth_ = scratch_ / "truth.tum";
  std::filesystem::path recording_ = scratch_ / "log.bag";
  std::string out_;
  std::string err_;
};

TEST_F(UnknownMountingTest, IsFoundBeforeMapping) {
  forget_mounting();
  map("found");
  EXPECT_THAT(err_, HasSubstr(kFound));
  EXPECT_THAT(err_, HasSubstr("180.0 deg"));
  EXPECT_LT(rms_m(), 0.1);
  const std::string report = read_file(scratch_ / "found" / "report.json");
  EXPECT_THAT(report, HasSubstr("\"laser_found\""));
  EXPECT_THAT(report, HasSubstr("\"heading_known\": true"));

  map("stated", {"--laser", "-0.2,0,3.14159"});
  EXPECT_THAT(err_, Not(HasSubstr(kFound)));
  EXPECT_LT(rms_m(), 0.1);
  EXPECT_THAT(read_file(scratch_ / "stated" / "report.json"), Not(HasSubstr("\"laser_found\"")));
}

TEST_F(UnknownMountingTest, UpsideDownIsFoundByServicesAndContinuedToo) {
  forget_mounting({"--upside-down"});
  map("map");
  EXPECT_THAT(err_, HasSubstr(", upside down"));
  EXPECT_LT(rms_m(), 0.1);
  const std::filesystem::path stored = scratch_ / "map" / "map.pb";
  ASSERT_EQ(run({"run", "--log", recording_, "--out", scratch_ / "run", "--workers", "0",
                 "--domain", own_domain()}),
            0)
      << err_;
  EXPECT_THAT(err_, HasSubstr(kFound));
  EXPECT_TRUE(read_file(scratch_ / "run" / "map.pb") == read_file(stored));
  ASSERT_EQ(run({"map", "--log", recording_, "--continue", stored, "--initial-pose=0,0,0", "--out",
                 scratch_ / "continued"}),
            0)
      << err_;
  EXPECT_THAT(err_, HasSubstr("as in "));
}

TEST_F(UnknownMountingTest, ScansThatContradictTheStatedOneAreReported) {
  record();
  map("right");
  EXPECT_THAT(err_, Not(HasSubstr("contradict")));
  record({"--upside-down"});
  map("mirrored", {}, 3);
  EXPECT_THAT(err_, HasSubstr("the scans contradict the stated mounting"));
  EXPECT_THAT(err_, HasSubstr("expected --upside-down"));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "mirrored" / "map.pb"));
  map("flag", {"--upside-down"});
  EXPECT_THAT(err_, Not(HasSubstr("contradict")));
  EXPECT_LT(rms_m(), 0.1);
}

TEST_F(UnknownMountingTest, AStatedHeadingThatTheScansContradictIsRefused) {
  simulation::SimulationOptions options;
  options.T_robot_laser = {-0.2, 0.0, std::numbers::pi};
  recording_ = log_;
  write_log("floor", log_, truth_, options, {});
  map("wrong", {}, 3);
  EXPECT_THAT(err_, HasSubstr("the laser is stated at 0 deg, but the scans show it at 180 deg"));
  EXPECT_THAT(err_, HasSubstr("if they are right, expected --laser -0."));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "wrong" / "map.pb"));
  map("right", {"--laser", "-0.2,0,3.14159"});
  EXPECT_LT(rms_m(), 0.1);
}

TEST_F(UnknownMountingTest, ALaserThatIsTurnedDuringTheDriveIsRefused) {
  const std::filesystem::path ahead = scratch_ / "ahead.clf";
  const std::filesystem::path back = scratch_ / "back.clf";
  simulation::SimulationOptions options;
  write_log("floor", ahead, truth_, options, {});
  options.T_robot_laser = {0.0, 0.0, std::numbers::pi};
  write_log("floor", back, truth_, options, {});
  std::ifstream first(ahead);
  std::ifstream second(back);
  std::vector<std::string> lines;
  std::vector<std::string> others;
  for (std::string line; std::getline(first, line);) lines.push_back(line);
  for (std::string line; std::getline(second, line);) others.push_back(line);
  ASSERT_EQ(lines.size(), others.size());
  recording_ = scratch_ / "turned.clf";
  std::ofstream file(recording_);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    file << (i < lines.size() / 2 ? lines : others)[i] << '\n';
  }
  file.close();
  map("turned", {}, 3);
  EXPECT_THAT(err_, HasSubstr("the laser does not stay where it is on the robot: until about "));
  EXPECT_THAT(err_, HasSubstr("add the second with --continue and --laser "));
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "turned" / "map.pb"));
}

TEST_F(UnknownMountingTest, CalibrationStartsThere) {
  forget_mounting();
  ASSERT_EQ(run({"calibrate-laser", recording_}), 0) << err_;
  EXPECT_THAT(out_, testing::ContainsRegex("x +-0\\.[12]"));
  EXPECT_THAT(out_, testing::ContainsRegex("yaw +[+-]1(79|80)\\."));
}

}  // namespace
}  // namespace topogeo::test
