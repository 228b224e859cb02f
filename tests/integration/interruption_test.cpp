// A run whose services die or that is stopped by the user.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/storage/read_map.hpp"

#include "program.hpp"
#include "simulated_drive.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class InterruptionTest : public testing::Test {
 protected:
  InterruptionTest() { use_udp_only(); }

  /// Options of a run that lasts 6 s with little work.
  std::vector<std::string> words() {
    write_log("ring", log_);
    return {"run", "--log",    log_,         "--out",  out_, "--workers",
            "1",   "--domain", own_domain(), "--rate", "8"};
  }

  /// A program that `interrupt` has ended. On a busy machine it may finish before the interruption,
  /// or be about to, for which `interrupt` returns false; then another one is started.
  template <class Interrupt>
  std::unique_ptr<Program> interrupted(const std::vector<std::string>& words,
                                       const Interrupt& interrupt) {
    std::unique_ptr<Program> program;
    EXPECT_TRUE(wait_for("a program that is interrupted before it is through", [&] {
      std::filesystem::remove_all(out_);
      program = std::make_unique<Program>(scratch_, "topogeo", words);
      const bool in_time = interrupt(*program);
      return program->wait() != 0 && in_time;
    }));
    return program;
  }
  /// Options of a run with a simulated robot that drives until Ctrl-C.
  [[nodiscard]] std::vector<std::string> simulated() const {
    return {"run",   "--sim",    write_world_of_rounds(scratch_),
            "--out", out_,       "--workers",
            "0",     "--domain", own_domain()};
  }
  static void freeze_for_2_s(pid_t process) {
    ::kill(process, SIGSTOP);
    std::this_thread::sleep_for(std::chrono::seconds(2));  // the time of the freeze
    ::kill(process, SIGCONT);
  }

  Scratch scratch_;
  std::string log_ = scratch_ / "log.clf.gz";
  std::string out_ = scratch_ / "out";
};

// Other services are restarted (EqualityTest), but only the simulator has the robot's pose.
TEST_F(InterruptionTest, WhatCannotBeStartedAgainIsNamedAndTheRestIsStopped) {
  Program run(scratch_, "topogeo", simulated());
  ASSERT_TRUE(DriveWatch().wait_for_distance(run, 0.5)) << run.err();
  const std::vector<pid_t> simulator = run.services("simulator");
  ASSERT_THAT(simulator, SizeIs(1));
  ::kill(simulator[0], SIGKILL);
  EXPECT_EQ(run.wait(), 1);
  EXPECT_THAT(run.err(), HasSubstr("simulator was killed by signal 9"));
  EXPECT_THAT(run.services(), IsEmpty());
}

// Peers may have dropped it without either side noticing.
TEST_F(InterruptionTest, AServiceThatWasFrozenIsStartedAgain) {
  set_longest_freeze(1);
  const std::vector<std::string> words = this->words();
  std::string err;
  // On a busy machine the run may be over before the mapper is frozen; then there is another run.
  ASSERT_TRUE(wait_for("a run whose local mapper ends", [&] {
    Program run(scratch_, "topogeo", words);
    run.wait_for_progress(20);
    const auto is_started_again = [&run] {
      return run.err().find("started again (1)") != std::string::npos;
    };
    // Its watchdog may have started only after the first freeze.
    EXPECT_TRUE(wait_for(
        "the local mapper to end", [&] { return is_started_again() || run.ended(); },
        [&run] {
          for (const pid_t pid : run.services("local_mapper")) freeze_for_2_s(pid);
        }))
        << run.err();
    EXPECT_EQ(run.wait(), 0) << run.err();
    err = run.err();
    return is_started_again();
  })) << err;
  EXPECT_THAT(err, HasSubstr("stood still for "));
}

// Only this process has the robot's pose: it reconnects to its peers without ending.
TEST_F(InterruptionTest, ASimulatorThatWasFrozenGoesOn) {
  set_longest_freeze(1);
  Program run(scratch_, "topogeo", simulated());
  DriveWatch drive;
  ASSERT_TRUE(drive.wait_for_distance(run, 0.5)) << run.err();
  const std::vector<pid_t> simulator = run.services("simulator");
  ASSERT_THAT(simulator, SizeIs(1));
  const auto freeze = [&] { freeze_for_2_s(simulator[0]); };
  const auto met_anew = [&] {
    return read_file(out_ + "/logs/simulator.log").find("connecting to the peers again") !=
           std::string::npos;
  };
  ASSERT_TRUE(wait_for(
      "the simulator to meet its peers anew", [&] { return met_anew() || run.ended(); }, freeze));
  ASSERT_TRUE(met_anew()) << run.err();
  ASSERT_TRUE(drive.wait_for_distance(run, 1.0)) << run.err();
  run.send_signal(SIGINT);
  EXPECT_EQ(run.wait(), 0) << run.err();
  EXPECT_THAT(run.err(), Not(HasSubstr("simulator ended")));
}

TEST_F(InterruptionTest, CtrlCStopsEverything) {
  std::vector<pid_t> services;
  const auto run = interrupted(words(), [&](Program& program) {
    program.wait_for_progress(20);
    services = program.services();
    program.send_signal(SIGINT);
    return services.size() == 6;
  });
  EXPECT_THAT(services, SizeIs(6));
  EXPECT_EQ(run->wait(), 128 + SIGINT);
  EXPECT_THAT(run->err(), HasSubstr("stopped, what was mapped is in"));
  EXPECT_THAT(run->services(), IsEmpty());
  EXPECT_GT(storage::read_map(out_ + "/map.pb").trajectory.stops.size(), 0U);
}

TEST_F(InterruptionTest, CtrlCWhileServicesStart) {
  const auto run = interrupted(words(), [](Program& program) {
    EXPECT_TRUE(
        wait_for("a service", [&] { return !program.services().empty() || program.ended(); }));
    program.send_signal(SIGINT);
    return true;
  });
  EXPECT_EQ(run->wait(), 128 + SIGINT);
  EXPECT_THAT(run->services(), IsEmpty());
}

TEST_F(InterruptionTest, ServicesDoNotOutliveAKilledRun) {
  const auto run = interrupted(words(), [](Program& program) {
    program.wait_for_progress(20);
    program.send_signal(SIGKILL);
    return true;
  });
  EXPECT_EQ(run->wait(), 128 + SIGKILL);
  EXPECT_TRUE(wait_for("the services to end", [&] { return run->services().empty(); }));
}

TEST_F(InterruptionTest, CtrlCStopsMapWithoutAnyResult) {
  write_log("floor", log_);
  const auto map = interrupted({"map", "--log", log_, "--out", out_}, [](Program& program) {
    program.wait_for_progress(20);
    program.send_signal(SIGINT);
    return true;
  });
  EXPECT_EQ(map->wait(), 128 + SIGINT);
  EXPECT_THAT(map->err(), HasSubstr("nothing was written"));
  EXPECT_TRUE(std::filesystem::is_empty(out_));
}

TEST_F(InterruptionTest, CtrlCStopsMapWhileItMatchesRevisitedPlaces) {
  write_log("floor", log_);
  const auto map = interrupted({"map", "--log", log_, "--out", out_}, [](Program& program) {
    program.wait_for_error_text("matching revisited places");
    program.send_signal(SIGINT);
    return true;
  });
  EXPECT_EQ(map->wait(), 128 + SIGINT);
  EXPECT_TRUE(std::filesystem::is_empty(out_));
}

}  // namespace
}  // namespace topogeo::test
