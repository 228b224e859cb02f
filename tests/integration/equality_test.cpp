// A run of all services over DDS produces the bytes of a run in one process, with any number of
// workers and whatever happens to them.
#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class EqualityTest : public testing::Test {
 protected:
  void map(const std::string& world) {
    write_log(world, log_);
    std::vector<std::string> words{"map", "--log", log_, "--out", scratch_ / "map"};
    words.insert(words.end(), configuration_.begin(), configuration_.end());
    Program program(scratch_, "topogeo", words);
    ASSERT_EQ(program.wait(), 0) << program.err();
    ASSERT_FALSE(read_file(scratch_ / "map" / "map.pb").empty());
  }

  /// The same for a drive that returns to earlier places: its late loops move earlier poses.
  void map_with_loops(const std::string& world) {
    ASSERT_NO_FATAL_FAILURE(map(world));
    EXPECT_GE(late_loops(), 10) << "the drive closes no loop that corrects it";
  }

  /// Number of loops that span more than half of the drive.
  int late_loops() {
    const auto report = nlohmann::json::parse(read_file(scratch_ / "map" / "report.json"));
    const int stops = report["counts"]["stops"];
    int late = 0;
    for (const auto& loop : report["loop_closures"]) {
      if (loop["later_stop"].get<int>() - loop["earlier_stop"].get<int>() > stops / 2) ++late;
    }
    return late;
  }

  std::vector<std::string> run_words(const std::string& out, int workers) {
    std::vector<std::string> words{"run",
                                   "--log",
                                   log_,
                                   "--out",
                                   scratch_ / out,
                                   "--workers",
                                   std::to_string(workers),
                                   "--domain",
                                   own_domain()};
    words.insert(words.end(), configuration_.begin(), configuration_.end());
    return words;
  }

  /// Slow enough to be interrupted half-way on most machines, with little work: it lasts 6 s.
  std::vector<std::string> slow_run_words(const std::string& out, int workers) {
    std::vector<std::string> words = run_words(out, workers);
    words.insert(words.end(), {"--rate", "8"});
    return words;
  }

  /// Kills processes of a service half-way through a run and expects the same bytes. On a busy
  /// machine the whole log may be mapped before; then there is another run. Returns the standard
  /// error of the last one.
  std::string kill_half_way(const std::string& service, std::size_t processes, int workers) {
    std::string err;
    EXPECT_TRUE(wait_for("a run that loses " + service + " half-way", [&] {
      Program run(scratch_, "topogeo", slow_run_words("run", workers));
      run.wait_for_progress(40);
      std::vector<pid_t> victims = run.services(service);
      const bool are_there = victims.size() >= processes;
      victims.resize(std::min(victims.size(), processes));
      for (const pid_t victim : victims) ::kill(victim, SIGKILL);
      EXPECT_EQ(run.wait(), 0) << run.err();
      expect_same_bytes("run");
      err = run.err();
      return are_there &&
             err.find("was killed by signal 9") < err.find("matching revisited places");
    })) << err;
    return err;
  }

  void expect_same_bytes(const std::string& out) {
    for (const char* file : {"trajectory.tum", "odometry.tum", "map.pb", "map.svg"}) {
      // No EXPECT_EQ: it would print megabytes.
      EXPECT_TRUE(read_file(scratch_ / out / file) == read_file(scratch_ / "map" / file))
          << file << " of " << out << " differs from that of the run in one process";
    }
  }

  Scratch scratch_;
  std::string log_ = scratch_ / "log.clf.gz";
  std::vector<std::string> configuration_;  // options for both commands
};

class EqualityByWorkersTest : public EqualityTest, public testing::WithParamInterface<int> {};

// Once round a block and on: the loop closes after 40 of 55 stops, and a stop has tasks for all
// workers.
TEST_P(EqualityByWorkersTest, Ring) {
  map_with_loops("ring");
  Program run(scratch_, "topogeo", run_words("run", GetParam()));
  ASSERT_EQ(run.wait(), 0) << run.err();
  expect_same_bytes("run");
  EXPECT_THAT(run.out(), HasSubstr("search: "));
  EXPECT_THAT(run.out(), Not(HasSubstr("fault of the localizer")));
  EXPECT_TRUE(run.services().empty());
}

INSTANTIATE_TEST_SUITE_P(Workers, EqualityByWorkersTest, testing::Values(0, 1, 2, 4),
                         [](const auto& workers) { return std::to_string(workers.param); });

// A long drive: more samples than the histories of their writers hold.
TEST_F(EqualityTest, Floor) {
  map_with_loops("floor");
  Program run(scratch_, "topogeo", run_words("run", 2));
  ASSERT_EQ(run.wait(), 0) << run.err();
  expect_same_bytes("run");
  EXPECT_THAT(run.out(), HasSubstr(" sent to workers"));
  EXPECT_THAT(run.out(), Not(HasSubstr("fault of the localizer")));
  EXPECT_TRUE(run.services().empty());
}

TEST_F(EqualityTest, WorkerKilledHalfWay) {
  use_udp_only();
  map_with_loops("ring");
  EXPECT_THAT(kill_half_way("ga_worker", 1, 2), HasSubstr("started again"));
}

class EqualityByRestartTest : public EqualityTest,
                              public testing::WithParamInterface<const char*> {};

TEST_P(EqualityByRestartTest, KilledHalfWay) {
  use_udp_only();
  map_with_loops("ring");
  const std::string err = kill_half_way(GetParam(), 1, 1);
  EXPECT_THAT(err, HasSubstr(std::string(GetParam()) + " was killed by signal 9"));
  EXPECT_THAT(err, HasSubstr("started again"));
}

INSTANTIATE_TEST_SUITE_P(Services, EqualityByRestartTest,
                         testing::Values("sensor_gateway", "local_mapper", "localizer", "map_store",
                                         "planner"),
                         [](const auto& service) { return std::string(service.param); });

TEST_F(EqualityTest, AllWorkersKilledHalfWay) {
  use_udp_only();
  map_with_loops("ring");
  kill_half_way("ga_worker", 2, 2);
}

constexpr const char* kSharedMemory = "/dev/shm/";

class SharedMemoryTest : public EqualityTest {
 protected:
  SharedMemoryTest() { ::setenv("TOPOGEO_DDS_PARTICIPANT", "local", 1); }
  ~SharedMemoryTest() override { ::unsetenv("TOPOGEO_DDS_PARTICIPANT"); }

  /// Names of the Fast DDS segments and ports that the programs have mapped.
  static std::set<std::string> mapped_by(const std::vector<pid_t>& programs) {
#if __has_include(<fastrtps/config.h>)  // Fast DDS 2
    const std::string begin = std::string(kSharedMemory) + "fastrtps_";
#else
    const std::string begin = std::string(kSharedMemory) + "fastdds_";
#endif
    std::set<std::string> names;
    for (const pid_t program : programs) {
      std::istringstream maps(read_file("/proc/" + std::to_string(program) + "/maps"));
      for (std::string line; std::getline(maps, line);) {
        const std::size_t at = line.find(begin);
        if (at == std::string::npos) continue;
        const std::string path = line.substr(at);
        names.insert(std::filesystem::path(path.substr(0, path.find(' '))).filename());
      }
    }
    return names;
  }

  static std::set<std::string> files() {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(kSharedMemory)) {
      names.insert(entry.path().filename());
    }
    return names;
  }

  /// Existing files of these segments and ports: the segments, their locks and semaphores.
  static std::set<std::string> files_of(const std::set<std::string>& mapped) {
    std::set<std::string> names;
    for (const std::string& file : files()) {
      for (const std::string& name : mapped) {
        if (file.find(name) != std::string::npos) names.insert(file);
      }
    }
    return names;
  }
};

// Other tests may use shared memory at the same time, and killed programs may have left ports: only
// files that these programs have mapped, and that are new, count.
TEST_F(SharedMemoryTest, SameBytesAndNothingIsLeft) {
  if (::access(kSharedMemory, W_OK) != 0) GTEST_SKIP() << kSharedMemory << " cannot be written";
  map("corridor");
  const std::set<std::string> before = files();
  std::vector<std::string> words = run_words("run", 1);
  words.insert(words.end(), {"--rate", "6"});  // long enough to see what it has mapped
  // On a busy machine the run may be over before its programs are observed; then there is another.
  const auto uses_shared_memory = [&] {
    Program run(scratch_, "topogeo", words);
    run.wait_for_progress(20);
    std::vector<pid_t> programs = run.services();
    programs.push_back(run.pid());
    const std::set<std::string> mapped = mapped_by(programs);
    const std::size_t files_mapped = files_of(mapped).size();
    EXPECT_EQ(run.wait(), 0) << run.err();
    expect_same_bytes("run");
    std::set<std::string> left = files_of(mapped);
    std::erase_if(left, [&](const std::string& file) { return before.contains(file); });
    EXPECT_THAT(left, testing::IsEmpty());
    return programs.size() > 1 && mapped.size() > programs.size() && files_mapped > mapped.size();
  };
  EXPECT_TRUE(wait_for("a segment and a port of each program", uses_shared_memory));
}

TEST_F(EqualityTest, TwoRunsAtOnceOnOneDomain) {
  map("corridor");
  Program first(scratch_, "topogeo", run_words("first", 1));
  Program second(scratch_, "topogeo", run_words("second", 2));
  ASSERT_EQ(first.wait(), 0) << first.err();
  ASSERT_EQ(second.wait(), 0) << second.err();
  expect_same_bytes("first");
  expect_same_bytes("second");
}

TEST_F(EqualityTest, SecondRunReplacesTheResultsOfTheFirst) {
  map("room");
  for (int i = 0; i < 2; ++i) {
    Program run(scratch_, "topogeo", run_words("run", 1));
    ASSERT_EQ(run.wait(), 0) << run.err();
    expect_same_bytes("run");
  }
}

// The Thesis's algorithm instead of the pose graph.
TEST_F(EqualityTest, ModeThesis) {
  std::ofstream(scratch_ / "thesis.yaml") << "localizer:\n  mode: thesis\n";
  configuration_ = {"--config", scratch_ / "thesis.yaml"};
  map("room");
  for (const int workers : {0, 2}) {
    const std::string out = "run" + std::to_string(workers);
    Program run(scratch_, "topogeo", run_words(out, workers));
    ASSERT_EQ(run.wait(), 0) << run.err();
    expect_same_bytes(out);
  }
}

}  // namespace
}  // namespace topogeo::test
