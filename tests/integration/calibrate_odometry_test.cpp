// topogeo calibrate-odometry finds the drift of the simulation, writes a configuration for mapping,
// and reports unusable inputs.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/simulation/odometry.hpp"

#include "command_test.hpp"
#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

/// A row of the table: the numbers of a parameter.
struct Row {
  double value = 0.0;
  double spread = 0.0;
  double corrected = 0.0;
  double corrected_spread = 0.0;
};

double number(std::string word) {
  if (!word.empty() && word.front() == '<') word.erase(0, 1);
  return std::stod(word);
}

/// The rows of the table by their keys.
std::map<std::string, Row> rows(const std::string& out) {
  std::map<std::string, Row> found;
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key, value, spread, configured, corrected, corrected_spread, stretches, unit;
    words >> key >> value >> spread >> configured >> corrected >> corrected_spread >> stretches >>
        unit;
    if (unit.empty() || (!unit.starts_with("m2/") && !unit.starts_with("rad2/"))) continue;
    found[key] = {number(value), number(spread), number(corrected), number(corrected_spread)};
  }
  return found;
}

/// "  distance  +2.01 +- 0.1 ...": the first number of the line that starts with this word.
double systematic(const std::string& out, const std::string& name) {
  std::istringstream lines(out);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    double value = 0.0;
    if (words >> word && word == name && words >> value) return value;
  }
  ADD_FAILURE() << "no line '" << name << "' in\n" << out;
  return 0.0;
}

class CalibrateOdometryTest : public CommandTest {
 protected:
  CalibrateOdometryTest() : CommandTest("calibrate-odometry") {}

  /// Expects the drift of simulation::OdometryDrift.
  void expect_simulated_drift() {
    const simulation::OdometryDrift drift;
    const auto table = rows(out_);
    ASSERT_EQ(table.size(), 5U) << out_;
    const auto expect = [&](const std::string& key, double sigma, double at_least) {
      const Row& row = table.at(key);
      EXPECT_NEAR(row.corrected, sigma * sigma, 4.0 * row.corrected_spread + at_least) << key;
      EXPECT_LT(row.corrected_spread, 4.0 * sigma * sigma + at_least) << key;
    };
    expect("translation_m2_per_m", drift.range_sigma_m_per_sqrt_m, 2e-5);
    expect("heading_rad2_per_m", drift.heading_sigma_rad_per_sqrt_m, 1e-5);
    expect("heading_rad2_per_rad", drift.turn_sigma_rad_per_sqrt_rad, 2e-5);
    EXPECT_LT(table.at("lateral_m2_per_m").corrected, 1e-4);
    EXPECT_LT(table.at("translation_m2_per_rad").corrected, 3e-4);
    EXPECT_GT(table.at("translation_m2_per_m").value,
              table.at("translation_m2_per_m").corrected);  // 2 % too long counts as noise
    EXPECT_NEAR(systematic(out_, "distance"), 100.0 * drift.range_scale_error, 0.5);
    EXPECT_NEAR(systematic(out_, "heading"),
                drift.heading_drift_rad_per_m * 180.0 / std::numbers::pi, 0.1);
    EXPECT_NEAR(systematic(out_, "turn"), 0.0, 1.0);
    EXPECT_NEAR(systematic(out_, "ahead"), 0.0, 0.02);
  }
};

TEST_F(CalibrateOdometryTest, HasHelpWithAnExample) {
  ASSERT_EQ(run({"--help"}), 0);
  EXPECT_THAT(out_, HasSubstr("Usage: topogeo calibrate-odometry"));
  EXPECT_THAT(out_, HasSubstr("topogeo calibrate-odometry drive.clf.gz --out robot.yaml"));
}

TEST_F(CalibrateOdometryTest, FindsTheDriftOfTheSimulationByMatching) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string out = scratch_ / "robot.yaml";
  write_log("floor", log);
  ASSERT_EQ(run({log, "--out", out}), 0) << err_;
  expect_simulated_drift();
  EXPECT_THAT(err_, HasSubstr("matching"));
  EXPECT_THAT(read_file(out), HasSubstr("odometry:\n  translation_m2_per_m: "));
  // The printed block equals that of the file.
  EXPECT_THAT(out_, HasSubstr(read_file(out).substr(read_file(out).find("odometry:"))));

  Program map(scratch_, "topogeo",
              {"map", "--log", log, "--config", out, "--out", scratch_ / "map"});
  EXPECT_EQ(map.wait(), 0) << map.err();
  EXPECT_TRUE(std::filesystem::exists(scratch_ / "map" / "map.pb"));
}

TEST_F(CalibrateOdometryTest, FindsTheSameByTheTruthAndKeepsTheRestOfAConfiguration) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string truth = scratch_ / "truth.tum";
  const std::string config = scratch_ / "mine.yaml";
  const std::string out = scratch_ / "robot.yaml";
  write_log("floor", log, truth);
  std::ofstream(config) << "stop: {distance_m: 1.25}\nodometry: {lateral_m2_per_m: 0.5}\n";
  ASSERT_EQ(run({log, "--reference", truth, "--config", config, "--out", out}), 0) << err_;
  expect_simulated_drift();
  Program shown(scratch_, "topogeo", {"config", "--config", out});
  ASSERT_EQ(shown.wait(), 0) << shown.err();
  EXPECT_THAT(shown.out(), HasSubstr("distance_m: 1.25"));
  EXPECT_THAT(shown.out(), testing::Not(HasSubstr("lateral_m2_per_m: 0.5")));
}

TEST_F(CalibrateOdometryTest, ALogThatIsTooShortIsToldWithNumbers) {
  const std::string log = scratch_ / "log.clf.gz";
  write_log("room", log);
  const int code = run({log});
  ASSERT_EQ(code, 3) << out_;
  EXPECT_THAT(err_, HasSubstr("log.clf.gz: too little motion: "));
  EXPECT_THAT(err_, HasSubstr("expected at least 20"));
}

TEST_F(CalibrateOdometryTest, UnusableInputIsNamed) {
  const std::string log = scratch_ / "log.clf.gz";
  const std::string reference = scratch_ / "reference.tum";
  write_log("room", log);
  EXPECT_EQ(run({scratch_ / "none.clf"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.clf"));
  EXPECT_EQ(run({log, "--reference", scratch_ / "none.tum"}), 3);
  EXPECT_THAT(err_, HasSubstr("none.tum"));
  std::ofstream(reference) << "1.0 2.0 three\n";
  EXPECT_EQ(run({log, "--reference", reference}), 3);
  EXPECT_THAT(err_, HasSubstr("reference.tum:1"));
  std::ofstream(reference) << "90000 0 0 0 0 0 0 1\n90001 1 0 0 0 0 0 1\n";
  EXPECT_EQ(run({log, "--reference", reference}), 3);
  EXPECT_THAT(err_, HasSubstr("reference.tum: no two stops of the log lie within its time"));
  std::ofstream(scratch_ / "bad.yaml") << "stop:\n  distance_m: -1\n";
  EXPECT_EQ(run({log, "--config", scratch_ / "bad.yaml"}), 2);
  EXPECT_THAT(err_, HasSubstr("stop.distance_m"));
  EXPECT_EQ(run({log, "--out", scratch_ / "no" / "x.yaml"}), 1);
  EXPECT_THAT(err_, HasSubstr("x.yaml"));
  EXPECT_EQ(run({}), 2);
  EXPECT_THAT(err_, StartsWith("topogeo: "));
}

}  // namespace
}  // namespace topogeo::test
