// topogeo calibrate-laser finds the mounting of the simulated laser, and reports what a log cannot
// determine.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_test.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using geometry::Pose2;
using testing::HasSubstr;

constexpr double kRadians = std::numbers::pi / 180.0;

/// " x +0.095 +- 0.001 m forward": the first two numbers of the line with this name.
struct Part {
  double value = 0.0;
  double spread = 0.0;
};

class CalibrateLaserTest : public CommandTest {
 protected:
  CalibrateLaserTest() : CommandTest("calibrate-laser") {}

  [[nodiscard]] Part part(const std::string& name) const {
    std::istringstream lines(out_);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word;
      std::string sign;
      Part found;
      if (words >> word && word == name && words >> found.value >> sign >> found.spread) {
        return found;
      }
    }
    ADD_FAILURE() << "no line '" << name << "' with two numbers in\n" << out_;
    return {};
  }

  void write_simulated(const std::string& world, const Pose2& T_robot_laser, std::uint64_t seed,
                       const std::filesystem::path& truth = {}) {
    simulation::SimulationOptions options;
    options.T_robot_laser = T_robot_laser;
    options.seed = seed;
    write_log(world, log_, truth, options);
  }

  /// Each part must lie within three of its spreads plus the rounding to a millimetre.
  void expect_mounting(const Pose2& truth) const {
    const Part x = part("x");
    const Part y = part("y");
    const Part yaw = part("yaw");
    EXPECT_NEAR(x.value, truth.x_m, 3.0 * x.spread + 0.001);
    EXPECT_NEAR(y.value, truth.y_m, 3.0 * y.spread + 0.001);
    EXPECT_NEAR(yaw.value * kRadians, truth.theta_rad, (3.0 * yaw.spread + 0.001) * kRadians);
    EXPECT_LT(x.spread, 0.02);  // the interval above is narrow
    EXPECT_LT(y.spread, 0.02);
    EXPECT_LT(yaw.spread, 1.0);
  }

  std::filesystem::path log_ = scratch_ / "log.clf.gz";
};

TEST_F(CalibrateLaserTest, HasHelpWithAnExample) {
  ASSERT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out_, HasSubstr("Usage: topogeo calibrate-laser"));
  EXPECT_THAT(out_, HasSubstr("topogeo calibrate-laser drive.clf.gz --out robot.yaml"));
}

TEST_F(CalibrateLaserTest, FindsALaserAtTheFrontAndMapsWithIt) {
  const Pose2 mounting{0.22, -0.06, 0.05};
  const std::filesystem::path truth = scratch_ / "truth.tum";
  const std::filesystem::path out = scratch_ / "laser.yaml";
  write_simulated("floor", mounting, 3, truth);
  ASSERT_EQ(run({log_, "--out", out}), 0) << err_;
  expect_mounting(mounting);
  EXPECT_THAT(read_file(out), HasSubstr("laser:\n  x_m: "));
  EXPECT_THAT(out_, HasSubstr(read_file(out).substr(read_file(out).find("laser:"))));

  // Poses are those of the robot, so they are right when the laser's mounting is.
  const auto rms_m = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"map",         "--log", log_, "--out", scratch_ / "map",
                                      "--reference", truth};
    words.insert(words.end(), more.begin(), more.end());
    Program map(scratch_, "topogeo", words);
    EXPECT_EQ(map.wait(), 0) << map.err();
    std::istringstream line(map.out().substr(map.out().find("  corrected")));
    std::string word;
    double value = 0.0;
    line >> word >> value;
    return value;
  };
  EXPECT_LT(rms_m({"--config", out}), 0.1);
}

TEST_F(CalibrateLaserTest, FindsALaserInACornerThatLooksAside) {
  const Pose2 mounting{-0.1, 0.25, -0.2};
  write_simulated("floor", mounting, 4);
  ASSERT_EQ(run({log_}), 0) << err_;
  expect_mounting(mounting);
}

TEST_F(CalibrateLaserTest, StartsFromTheConfigurationAndKeepsTheRestOfIt) {
  const Pose2 mounting{0.1, 0.05, 1.6};
  const std::filesystem::path config = scratch_ / "mine.yaml";
  const std::filesystem::path out = scratch_ / "robot.yaml";
  write_simulated("floor", mounting, 5);
  std::ofstream(config) << "stop: {distance_m: 0.9}\nlaser: {yaw_rad: 1.5}\n";
  ASSERT_EQ(run({log_, "--config", config, "--out", out}), 0) << err_;
  expect_mounting(mounting);
  Program shown(scratch_, "topogeo", {"config", "--config", out});
  ASSERT_EQ(shown.wait(), 0) << shown.err();
  EXPECT_THAT(shown.out(), HasSubstr("distance_m: 0.9"));
}

TEST_F(CalibrateLaserTest, AnExactlyKnownMountingIsFoundAgainWithoutAnyNoise) {
  simulation::SimulationOptions options;
  options.T_robot_laser = {0.15, 0.0, 0.0};
  options.laser.sigma_m = 0.0;
  options.laser.resolution_m = 0.0;
  options.laser.dropout_probability = 0.0;
  options.odometry = {0.0, 0.0, 0.0, 0.0, 0.0};
  write_log("floor", log_, {}, options);
  ASSERT_EQ(run({log_}), 0) << err_;
  EXPECT_NEAR(part("x").value, 0.15, 0.003);
  EXPECT_NEAR(part("y").value, 0.0, 0.003);
  EXPECT_NEAR(part("yaw").value, 0.0, 0.1);
}

TEST_F(CalibrateLaserTest, AShortDriveShowsTheMountingRoughly) {
  write_simulated("room", {0.0, 0.0, std::numbers::pi}, 1);
  ASSERT_EQ(run({log_}), 0) << err_;
  EXPECT_THAT(out_, HasSubstr("log.clf.gz: too little motion: "));
  EXPECT_THAT(out_, HasSubstr("motions shows:"));
  EXPECT_NEAR(std::fabs(part("yaw").value), 180.0, 3.0 * part("yaw").spread);
}

TEST_F(CalibrateLaserTest, UnusableInputIsNamed) {
  simulation::SimulationOptions sparse;  // some scans without a common view
  sparse.scan_step_m = 10.0;
  sparse.scan_step_rad = std::numbers::pi;
  write_log("room", log_, {}, sparse);
  EXPECT_EQ(run({log_}), 3);
  EXPECT_THAT(err_, HasSubstr("log.clf.gz: too little motion: "));
  EXPECT_EQ(run({scratch_ / "none.clf"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.clf"));
  std::ofstream(scratch_ / "bad.yaml") << "laser: {x_m: 9}\n";
  EXPECT_EQ(run({log_, "--config", scratch_ / "bad.yaml"}), 2);
  EXPECT_THAT(err_, HasSubstr("laser.x_m"));
  EXPECT_EQ(run({log_, "--out", scratch_ / "no" / "x.yaml"}), 1);
  EXPECT_THAT(err_, HasSubstr("x.yaml"));
}

}  // namespace
}  // namespace topogeo::test
