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

class DyingServiceTest : public InterruptionTest,
                         public testing::WithParamInterface<const char*> {};

TEST_P(DyingServiceTest, IsNamedAndTheRestIsStopped) {
  Program run(scratch_, "topogeo", words());
  run.wait_for_progress(20);
  const std::vector<pid_t> service = run.services(GetParam());
  ASSERT_THAT(service, SizeIs(1));
  ::kill(service[0], SIGKILL);
  EXPECT_EQ(run.wait(30), 1);
  EXPECT_THAT(run.err(), HasSubstr(std::string(GetParam()) + " was killed by signal 9"));
  EXPECT_THAT(run.services(), IsEmpty());
}

// The rest can be started again (EqualityTest); who reads a log would miss a part of it.
INSTANTIATE_TEST_SUITE_P(Services, DyingServiceTest,
                         testing::Values("sensor_gateway", "local_mapper"),
                         [](const auto& service) { return std::string(service.param); });

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
