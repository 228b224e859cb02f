// A log without odometry is mapped by odometry from its scans.
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class LaserOdometryMapTest : public testing::Test {
 protected:
  /// Drives through a world and deletes the odometry of the log.
  void drive(const std::string& world, const simulation::SimulationOptions& options = {}) {
    write_log(world, recorded_, truth_, options);
    scan::CarmenLogReader reader(recorded_);
    scan::CarmenLogWriter writer(log_);
    while (std::optional<scan::Scan> scan = reader.next()) {
      scan->T_odom_robot = {};
      writer.write(*scan);
    }
    writer.close();
  }

  /// Exit code of `topogeo map`.
  int map(const std::filesystem::path& log, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"map",         "--log", log, "--out", scratch_ / "map",
                                   "--reference", truth_};
    words.insert(words.end(), more.begin(), more.end());
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out_ = program.out();
    err_ = program.err();
    return code;
  }

  /// RMS error of the corrected trajectory against the truth.
  [[nodiscard]] double rms_m() const {
    std::istringstream line(out_.substr(out_.find("  corrected")));
    std::string word;
    double value = 1e9;
    line >> word >> value;
    return value;
  }
  [[nodiscard]] std::string report() const { return read_file(scratch_ / "map" / "report.json"); }

  Scratch scratch_;
  std::filesystem::path recorded_ = scratch_ / "recorded.clf.gz";
  std::filesystem::path log_ = scratch_ / "log.clf.gz";
  std::filesystem::path truth_ = scratch_ / "truth.tum";
  std::string out_;
  std::string err_;
};

TEST_F(LaserOdometryMapTest, IsChosenForALogWhoseOdometryStands) {
  drive("room");
  ASSERT_EQ(map(log_), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("topogeo: odometry from the scans: the log's stays at one pose while "
                              "the scans move\n"));
  EXPECT_THAT(report(), HasSubstr("\"laser_odometry\""));
  EXPECT_LT(rms_m(), 0.05);
  ASSERT_EQ(map(recorded_), 0) << err_;
  EXPECT_THAT(err_, Not(HasSubstr("odometry from the scans")));
  EXPECT_THAT(report(), Not(HasSubstr("\"laser_odometry\"")));
}

TEST_F(LaserOdometryMapTest, IsChosenByTheConfiguration) {
  drive("room");
  std::ofstream(scratch_ / "laser.yaml") << "odometry: {source: laser}\n";
  ASSERT_EQ(map(recorded_, {"--config", scratch_ / "laser.yaml"}), 0) << err_;
  EXPECT_THAT(err_, HasSubstr("topogeo: odometry from the scans: odometry.source is laser\n"));
  EXPECT_THAT(err_, HasSubstr("if the map is a mirror image of the building, expected --upside-"));
  EXPECT_LT(rms_m(), 0.05);
  std::ofstream(scratch_ / "recorded.yaml") << "odometry: {source: recorded}\n";
  map(log_, {"--config", scratch_ / "recorded.yaml"});
  EXPECT_THAT(err_, Not(HasSubstr("topogeo: odometry from the scans")));
  EXPECT_THAT(report(), Not(HasSubstr("\"laser_odometry\"")));
}

TEST_F(LaserOdometryMapTest, ServicesMakeTheSame) {
  drive("room");
  ASSERT_EQ(map(log_), 0) << err_;
  Program program(scratch_, "topogeo",
                  {"run", "--log", log_, "--out", scratch_ / "run", "--workers", "0", "--domain",
                   own_domain()});
  ASSERT_EQ(program.wait(), 0) << program.err();
  EXPECT_THAT(program.err(), HasSubstr("topogeo: odometry from the scans: the log's stays at one"));
  for (const char* file : {"map.pb", "trajectory.tum"}) {
    EXPECT_TRUE(read_file(scratch_ / "run" / file) == read_file(scratch_ / "map" / file)) << file;
  }
  EXPECT_THAT(read_file(scratch_ / "run" / "report.json"), HasSubstr("\"laser_odometry\""));
}

TEST_F(LaserOdometryMapTest, RefusesSparseScans) {
  simulation::SimulationOptions sparse;
  sparse.scan_step_m = 1.2;
  sparse.scan_step_rad = 1.0;
  drive("floor", sparse);
  EXPECT_EQ(map(log_), 3);
  EXPECT_THAT(err_, HasSubstr("the scans are too sparse for odometry from them"));
}

}  // namespace
}  // namespace topogeo::test
