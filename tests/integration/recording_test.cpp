// One drive, recorded in each format of logs, gives the same map.
#include <cmath>
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

class RecordingTest : public testing::Test {
 protected:
  RecordingTest() {
    simulation::SimulationOptions options;
    options.T_robot_laser = {0.2, 0.1, 0.0};
    write_log("room", native_, {}, options, options.T_robot_laser);
  }

  void run(const std::vector<std::string>& words) {
    Program program(scratch_, "topogeo", words);
    ASSERT_EQ(program.wait(), 0) << program.err();
    out_ = program.out();
    err_ = program.err();
  }

  void map(const std::filesystem::path& log, const std::string& out) {
    run({"map", "--log", log.string(), "--out", (scratch_ / out).string()});
  }

  Scratch scratch_;
  std::filesystem::path native_ = scratch_ / "native.clf.gz";
  std::string out_;
  std::string err_;
};

/// x and y of each line "t x y z ...".
std::vector<std::pair<double, double>> positions(const std::filesystem::path& trajectory) {
  std::vector<std::pair<double, double>> found;
  std::ifstream file(trajectory);
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    double time = 0.0;
    double x = 0.0;
    double y = 0.0;
    if (words >> time >> x >> y) found.emplace_back(x, y);
  }
  return found;
}

TEST_F(RecordingTest, GivesTheSameMapInEachFormat) {
  const auto mcap = scratch_ / "drive.mcap";
  run({"convert", native_.string(), mcap.string()});
  map(mcap, "mcap");
  EXPECT_THAT(err_, HasSubstr("scans from /scan"));
  EXPECT_THAT(err_, HasSubstr("laser 0.200 m ahead, 0.100 m to the left"));
  for (const char* name : {"drive.db3", "drive.bag", "drive.clf.gz"}) {
    SCOPED_TRACE(name);
    run({"convert", mcap.string(), (scratch_ / name).string()});
    map(scratch_ / name, std::string("out_") + name);
    for (const char* file : {"map.pb", "trajectory.tum", "odometry.tum"}) {
      EXPECT_TRUE(read_file(scratch_ / (std::string("out_") + name) / file) ==
                  read_file(scratch_ / "mcap" / file))
          << file;
    }
  }
  map(native_, "native");
  const auto native = positions(scratch_ / "native" / "trajectory.tum");
  const auto recorded = positions(scratch_ / "mcap" / "trajectory.tum");
  ASSERT_EQ(native.size(), recorded.size());
  ASSERT_GT(native.size(), 20U);
  for (std::size_t i = 0; i < native.size(); ++i) {
    EXPECT_LE(
        std::hypot(native[i].first - recorded[i].first, native[i].second - recorded[i].second),
        0.001)
        << i;
  }
}

TEST_F(RecordingTest, IsMadeOfARunAndGivesItsMap) {
  const auto mcap = scratch_ / "run.mcap";
  run({"run", "--log", native_.string(), "--out", (scratch_ / "run").string(), "--record",
       mcap.string(), "--workers", "1", "--domain", own_domain()});
  map(mcap, "again");
  const auto first = positions(scratch_ / "run" / "trajectory.tum");
  const auto again = positions(scratch_ / "again" / "trajectory.tum");
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_LE(std::hypot(first[i].first - again[i].first, first[i].second - again[i].second),
              0.001);
  }
  run({"check-log", mcap.string()});
  EXPECT_THAT(out_, HasSubstr("no fault found"));
}

TEST_F(RecordingTest, IsReplayedByTheServices) {
  const auto bag = scratch_ / "drive.bag";
  run({"convert", native_.string(), bag.string(), "--compression", "lz4"});
  map(bag, "map");
  run({"run", "--log", bag.string(), "--out", (scratch_ / "run").string(), "--workers", "1",
       "--scan-topic", "/scan", "--odometry-topic", "/tf", "--domain", own_domain()});
  EXPECT_TRUE(read_file(scratch_ / "run" / "map.pb") == read_file(scratch_ / "map" / "map.pb"));
}

TEST_F(RecordingTest, IsRefusedWithItsNameAndWhatItHas) {
  const auto mcap = scratch_ / "drive.mcap";
  run({"convert", native_.string(), mcap.string()});
  Program program(scratch_, "topogeo",
                  {"map", "--log", mcap.string(), "--out", (scratch_ / "no").string(),
                   "--scan-topic", "/front"});
  EXPECT_EQ(program.wait(), 3);
  EXPECT_THAT(program.err(), HasSubstr("drive.mcap: expected laser scans"));
  EXPECT_THAT(program.err(), HasSubstr("/scan (sensor_msgs/msg/LaserScan)"));
}

}  // namespace
}  // namespace topogeo::test
