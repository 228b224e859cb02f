// Continuing a stored map: over DDS as in one process, when the robot is not found in the map, and
// with maps that cannot be continued.
#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/simulate_log.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// Writes a part of the log of a drive, cut at shares of its scans, as a log of its own.
void write_part(const std::string& world, const std::filesystem::path& log, double from,
                double to) {
  const auto file = std::filesystem::path(TOPOGEO_SHARE) / "worlds" / (world + ".world.yaml");
  const auto simulated = simulation::simulate_log(world::load_world(file), {});
  const auto count = static_cast<double>(simulated.scans.size());
  scan::CarmenLogWriter writer(log);
  for (auto i = static_cast<std::size_t>(from * count); i < static_cast<std::size_t>(to * count);
       ++i) {
    writer.write(simulated.scans[i]);
  }
  writer.close();
}

struct Outcome {
  int code = 0;
  std::string out;
  std::string err;
};

class ContinueTest : public testing::Test {
 protected:
  Outcome call(std::vector<std::string> words, const std::string& out) {
    words.insert(words.end(), {"--out", scratch_ / out});
    if (words.front() == "run") words.insert(words.end(), {"--domain", own_domain()});
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    return {code, program.out(), program.err()};
  }
  void make_map(double share) {
    write_part("ring", scratch_ / "first.clf.gz", 0.0, share);
    const Outcome mapped = call({"map", "--log", scratch_ / "first.clf.gz"}, "map");
    ASSERT_EQ(mapped.code, 0) << mapped.err;
  }
  json report(const std::string& out) {
    return json::parse(read_file(scratch_ / out / "report.json"));
  }
  /// Outcomes of `map --continue` and `run --continue` with so many workers, in folders of these
  /// names.
  struct Both {
    Outcome alone;
    Outcome run;
  };
  Both map_and_run(const std::string& log, int workers) {
    return {call({"map", "--log", log, "--continue", map_}, "alone"),
            call({"run", "--log", log, "--continue", map_, "--workers", std::to_string(workers)},
                 "run")};
  }
  void expect_same_files(const std::string& a, const std::string& b) {
    for (const char* file : {"map.pb", "trajectory.tum", "odometry.tum"}) {
      EXPECT_TRUE(read_file(scratch_ / a / file) == read_file(scratch_ / b / file)) << file;
    }
  }

  Scratch scratch_;
  std::string map_ = scratch_ / "map" / "map.pb";
};

class ContinueByWorkersTest : public ContinueTest, public testing::WithParamInterface<int> {};

TEST_P(ContinueByWorkersTest, OverDdsItGivesTheBytesOfOneProcess) {
  make_map(0.6);
  const std::string before = read_file(map_);
  const std::string log = scratch_ / "second.clf.gz";
  write_part("ring", log, 0.6, 1.0);
  const auto [alone, run] = map_and_run(log, GetParam());
  ASSERT_EQ(alone.code, 0) << alone.err;
  ASSERT_EQ(run.code, 0) << run.err;
  expect_same_files("alone", "run");
  EXPECT_TRUE(read_file(map_) == before);
  const json continuation = report("alone")["continuation"];
  EXPECT_EQ(continuation, report("run")["continuation"]);
  EXPECT_EQ(continuation["stored_stops"], report("map")["counts"]["stops"]);
  EXPECT_GT(continuation["added_stops"].get<int>(), 20);
  EXPECT_EQ(continuation["unmapped_stops"], 0);
  EXPECT_THAT(alone.out, HasSubstr("continued map: "));
  EXPECT_THAT(run.out, testing::Not(HasSubstr("fault of the localizer")));
}

TEST_F(ContinueTest, ALogThatIsAddedToItsOwnMapIsAnotherSession) {
  make_map(0.4);
  const std::string log = scratch_ / "again.clf.gz";
  write_part("ring", log, 0.0, 0.4);
  const auto [alone, run] = map_and_run(log, 0);
  ASSERT_EQ(alone.code, 0) << alone.err;
  ASSERT_EQ(run.code, 0) << run.err;
  expect_same_files("alone", "run");
  const json continuation = report("run")["continuation"];
  EXPECT_EQ(continuation["added_stops"], continuation["stored_stops"]);
}

INSTANTIATE_TEST_SUITE_P(Workers, ContinueByWorkersTest, testing::Values(1, 2, 4),
                         [](const auto& workers) { return std::to_string(workers.param); });

TEST_F(ContinueTest, WhereTheRobotIsNotFoundTheMapIsAsItWas) {
  make_map(0.3);
  const std::string log = scratch_ / "elsewhere.clf.gz";
  write_part("room", log, 0.0, 1.0);
  const auto [alone, run] = map_and_run(log, 1);
  ASSERT_EQ(alone.code, 0) << alone.err;
  ASSERT_EQ(run.code, 0) << run.err;
  for (const Outcome& outcome : {alone, run}) {
    EXPECT_THAT(outcome.err, HasSubstr("the robot was not localized in the map ("));
    EXPECT_THAT(outcome.err, HasSubstr("the map is unchanged"));
  }
  for (const char* out : {"alone", "run"}) {
    EXPECT_TRUE(read_file(scratch_ / out / "map.pb") == read_file(map_)) << out;
    EXPECT_EQ(report(out)["continuation"]["added_stops"], 0);
    EXPECT_GT(report(out)["continuation"]["unmapped_stops"].get<int>(), 5);
  }
}

TEST_F(ContinueTest, PosesOfStopsThatAreSearchedForAreInNoTrajectory) {
  make_map(0.3);
  const std::string log = scratch_ / "elsewhere.clf.gz";
  write_part("room", log, 0.0, 1.0);
  const Outcome localized = call({"localize", "--log", log, "--map", map_}, "out");
  ASSERT_EQ(localized.code, 0) << localized.err;
  const auto lines_of = [&](const char* file) {
    const std::string text = read_file(scratch_ / "out" / file);
    return std::count(text.begin(), text.end(), '\n');
  };
  EXPECT_THAT(read_file(scratch_ / "out" / "localization.csv"), HasSubstr(",SEARCHING,"));
  EXPECT_LT(lines_of("trajectory.tum"), lines_of("odometry.tum"));
}

TEST_F(ContinueTest, AContinuedMapIsContinuedAgain) {
  make_map(0.5);
  write_part("ring", scratch_ / "second.clf.gz", 0.5, 0.75);
  write_part("ring", scratch_ / "third.clf.gz", 0.75, 1.0);
  const Outcome second =
      call({"map", "--log", scratch_ / "second.clf.gz", "--continue", map_}, "two");
  ASSERT_EQ(second.code, 0) << second.err;
  const Outcome third =
      call({"map", "--log", scratch_ / "third.clf.gz", "--continue", scratch_ / "two" / "map.pb"},
           "three");
  ASSERT_EQ(third.code, 0) << third.err;
  EXPECT_EQ(report("three")["continuation"]["stored_stops"], report("two")["counts"]["stops"]);
  EXPECT_GT(report("three")["continuation"]["added_stops"].get<int>(), 10);
}

TEST_F(ContinueTest, MapsThatCannotBeContinuedAreOneLineErrors) {
  make_map(0.2);
  const std::string log = scratch_ / "first.clf.gz";
  std::string bytes = read_file(map_);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x10);
  std::ofstream(scratch_ / "damaged.pb", std::ios::binary) << bytes;
  std::ofstream(scratch_ / "empty.pb", std::ios::binary) << "";
  std::ofstream(scratch_ / "laser.yaml") << "laser: {x_m: 0.2}\n";
  std::ofstream(scratch_ / "thesis.yaml") << "localizer: {mode: thesis}\n";
  struct Case {
    std::vector<std::string> words;
    int code;
    std::string message;
  };
  const std::vector<Case> cases = {
      {{"--continue", scratch_ / "damaged.pb"}, 3, "damaged.pb: cut short or damaged"},
      {{"--continue", scratch_ / "empty.pb"}, 3, "empty.pb: empty"},
      {{"--continue", scratch_ / "none.pb"}, 3, "none.pb"},
      {{"--continue", map_, "--robot", "other"}, 3, "is of robot 'robot', expected 'other'"},
      {{"--continue", map_, "--config", scratch_ / "laser.yaml"}, 3, "made with the laser at"},
      {{"--continue", map_, "--config", scratch_ / "thesis.yaml"}, 2, "localizer.mode graph"},
      {{"--initial-pose", "1,2,3"}, 2, "--initial-pose: expected with a stored map"},
  };
  for (const Case& c : cases) {
    for (const char* command : {"map", "run"}) {
      std::vector<std::string> words{command, "--log", log};
      words.insert(words.end(), c.words.begin(), c.words.end());
      const Outcome outcome = call(words, "out");
      EXPECT_EQ(outcome.code, c.code) << c.message;
      EXPECT_THAT(outcome.err, HasSubstr(c.message));
    }
  }
  const Outcome both = call({"run", "--log", log, "--continue", map_, "--map", map_}, "out");
  EXPECT_EQ(both.code, 2);
  Program service(scratch_, "localizer",
                  {"--domain", own_domain(), "--continue", map_, "--robot-id", "other"});
  EXPECT_EQ(service.wait(), 3);
  EXPECT_THAT(service.err(), HasSubstr("is of robot 'robot', expected 'other'"));
}

}  // namespace
}  // namespace topogeo::test
