// A log whose two poses imply a laser ahead of the robot's origin is mapped with that mounting.
#include <filesystem>
#include <fstream>
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

constexpr const char* kFromTheLog =
    "topogeo: laser 0.400 m ahead, 0.000 m to the left, 0.0 deg: from the log\n";

class LaserMountingTest : public testing::Test {
 protected:
  LaserMountingTest() {
    simulation::SimulationOptions options;
    options.T_robot_laser = {0.4, 0.0, 0.0};
    write_log("room", log_, truth_, options, options.T_robot_laser);
  }

  /// Runs `topogeo WORDS...`, which must succeed.
  void run(const std::vector<std::string>& words) {
    Program program(scratch_, "topogeo", words);
    ASSERT_EQ(program.wait(), 0) << program.err();
    out_ = program.out();
    err_ = program.err();
  }

  void map(const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"map",          "--log",       log_,  "--out",
                                   scratch_ / out, "--reference", truth_};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
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
  std::string out_;
  std::string err_;
};

TEST_F(LaserMountingTest, TheLogStatesItAndTheConfigurationWins) {
  map("log");
  EXPECT_THAT(err_, HasSubstr(kFromTheLog));
  EXPECT_LT(rms_m(), 0.05);
  const double rms_of_log_m = rms_m();
  EXPECT_THAT(read_file(scratch_ / "log" / "report.json"), HasSubstr("\"laser.x_m\": \"0.4\""));

  std::ofstream(scratch_ / "same.yaml") << "laser: {x_m: 0.4}\n";
  map("same", {"--config", scratch_ / "same.yaml"});
  EXPECT_THAT(err_, Not(HasSubstr("laser")));
  EXPECT_TRUE(read_file(scratch_ / "same" / "map.pb") == read_file(scratch_ / "log" / "map.pb"));

  std::ofstream(scratch_ / "other.yaml") << "laser: {x_m: 0}\n";
  map("other", {"--config", scratch_ / "other.yaml"});
  EXPECT_THAT(err_, HasSubstr("topogeo: warning: laser 0.000 m ahead, 0.000 m to the left, 0.0 deg"
                              ": from the configuration, but the log states 0.400 m ahead"));
  EXPECT_GT(rms_m(), 2.0 * rms_of_log_m);
}

TEST_F(LaserMountingTest, ServicesAndARecordingHaveItToo) {
  map("map");
  const std::filesystem::path recorded = scratch_ / "recorded.clf";
  run({"run", "--log", log_, "--out", scratch_ / "run", "--workers", "0", "--domain", own_domain(),
       "--record", recorded});
  EXPECT_THAT(err_, HasSubstr(kFromTheLog));
  EXPECT_TRUE(read_file(scratch_ / "run" / "map.pb") == read_file(scratch_ / "map" / "map.pb"));
  log_ = recorded;
  map("replayed");
  EXPECT_THAT(err_, HasSubstr(kFromTheLog));
  EXPECT_TRUE(read_file(scratch_ / "replayed" / "trajectory.tum") ==
              read_file(scratch_ / "map" / "trajectory.tum"));
}

TEST_F(LaserMountingTest, AMapIsContinuedAndLocalizedInWithIt) {
  map("map");
  const std::filesystem::path stored = scratch_ / "map" / "map.pb";
  run({"map", "--log", log_, "--continue", stored, "--initial-pose=0,0,0", "--out",
       scratch_ / "continued"});
  EXPECT_THAT(err_, HasSubstr(kFromTheLog));
  run({"localize", "--log", log_, "--map", stored, "--initial-pose=0,0,0", "--out",
       scratch_ / "localized"});
  EXPECT_THAT(err_, HasSubstr(kFromTheLog));
}

}  // namespace
}  // namespace topogeo::test
