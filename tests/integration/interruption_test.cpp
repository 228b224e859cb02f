// What happens to a run whose services die or that somebody stops.
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "topogeo/storage/read_map.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class InterruptionTest : public testing::Test {
 protected:
  InterruptionTest() {
    use_udp_only();
    write_log("floor", log_);
  }

  std::vector<std::string> words() {
    return {"run", "--log", log_, "--out", out_, "--workers", "1", "--domain", own_domain()};
  }

  Scratch scratch_;
  std::string log_ = scratch_ / "log.clf.gz";
  std::string out_ = scratch_ / "out";
};

// Services are started again (EqualityTest); the simulated robot is where it was nowhere else.
TEST_F(InterruptionTest, WhatCannotBeStartedAgainIsNamedAndTheRestIsStopped) {
  Program run(scratch_, "topogeo",
              {"run", "--sim", std::string(TOPOGEO_TEST_DATA) + "/short.world.yaml", "--out", out_,
               "--workers", "0", "--domain", own_domain()});
  run.wait_for_progress(10);
  const std::vector<pid_t> simulator = run.services("simulator");
  ASSERT_THAT(simulator, SizeIs(1));
  ::kill(simulator[0], SIGKILL);
  EXPECT_EQ(run.wait(30), 1);
  EXPECT_THAT(run.err(), HasSubstr("simulator was killed by signal 9"));
  EXPECT_THAT(run.services(), IsEmpty());
}

TEST_F(InterruptionTest, CtrlCStopsEverything) {
  Program run(scratch_, "topogeo", words());
  run.wait_for_progress(20);
  EXPECT_THAT(run.services(), SizeIs(6));
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(30), 128 + SIGINT);
  EXPECT_THAT(run.err(), HasSubstr("stopped, what was mapped is in"));
  EXPECT_THAT(run.services(), IsEmpty());
  EXPECT_GT(storage::read_map(out_ + "/map.pb").trajectory.stops.size(), 0U);
}

TEST_F(InterruptionTest, CtrlCWhileServicesStart) {
  Program run(scratch_, "topogeo", words());
  while (run.services().empty()) {
  }
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(30), 128 + SIGINT);
  EXPECT_THAT(run.services(), IsEmpty());
}

TEST_F(InterruptionTest, ServicesDoNotOutliveAKilledRun) {
  Program run(scratch_, "topogeo", words());
  run.wait_for_progress(20);
  run.send_signal(SIGKILL);
  EXPECT_EQ(run.wait(30), 128 + SIGKILL);
  for (int i = 0; i < 500 && !run.services().empty(); ++i) ::usleep(10'000);
  EXPECT_THAT(run.services(), IsEmpty());
}

TEST_F(InterruptionTest, CtrlCStopsMapWithoutAnyResult) {
  Program map(scratch_, "topogeo", {"map", "--log", log_, "--out", out_});
  map.wait_for_progress(20);
  map.send_signal(SIGINT);
  EXPECT_EQ(map.wait(30), 128 + SIGINT);
  EXPECT_THAT(map.err(), HasSubstr("nothing was written"));
  EXPECT_TRUE(std::filesystem::is_empty(out_));
}

TEST_F(InterruptionTest, CtrlCStopsMapWhileItMatchesRevisitedPlaces) {
  Program map(scratch_, "topogeo", {"map", "--log", log_, "--out", out_});
  map.wait_for_error_text("matching revisited places");
  map.send_signal(SIGINT);
  EXPECT_EQ(map.wait(30), 128 + SIGINT);
  EXPECT_TRUE(std::filesystem::is_empty(out_));
}

}  // namespace
}  // namespace topogeo::test
