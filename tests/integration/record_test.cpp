// topogeo record and topogeo check-log.
#include <csignal>
#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "topogeo/recording/message_source.hpp"

#include "command_test.hpp"
#include "program.hpp"
#include "waiting.hpp"

namespace topogeo::test {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Record : public testing::Test {
 protected:
  /// Replays `log` and records the gateway's output.
  void record(const fs::path& log, const fs::path& out) {
    const std::string domain = own_domain();
    Program recorder(
        scratch_, "topogeo",
        {"record", "--domain", domain, "--partition", "record", "--out", out.string()});
    Program gateway(
        scratch_, "sensor_gateway",
        {"--domain", domain, "--partition", "record", "--log", log.string(), "--exit-at-end"});
    EXPECT_EQ(recorder.wait(), 0) << recorder.err();
    EXPECT_EQ(gateway.wait(), 0) << gateway.err();
  }

  std::string map_of(const fs::path& log, const std::string& name) {
    const fs::path out = scratch_ / name;
    Program map(scratch_, "topogeo", {"map", "--log", log.string(), "--out", out.string()});
    EXPECT_EQ(map.wait(), 0) << map.err();
    return read_file(out / "map.pb");
  }

  Scratch scratch_;
};

TEST_F(Record, ReplayOfARecordIsTheSame) {
  const fs::path log = scratch_ / "log.clf";
  write_log("corridor", log);
  record(log, scratch_ / "first.clf.gz");
  record(scratch_ / "first.clf.gz", scratch_ / "second.clf");
  record(scratch_ / "second.clf", scratch_ / "third.clf");
  const std::string second = read_file(scratch_ / "second.clf");
  EXPECT_GT(second.size(), 10'000U);
  EXPECT_TRUE(second == read_file(scratch_ / "third.clf"));
  const std::string map = map_of(log, "map");
  EXPECT_FALSE(map.empty());
  EXPECT_TRUE(map == map_of(scratch_ / "first.clf.gz", "map_first"));
  EXPECT_TRUE(map == map_of(scratch_ / "third.clf", "map_third"));
}

TEST_F(Record, MapOfARunIsTheMapOfItsRecord) {
  const fs::path log = scratch_ / "log.clf";
  write_log("corridor", log);
  Program run(scratch_, "topogeo",
              {"run", "--log", log.string(), "--out", (scratch_ / "run").string(), "--record",
               (scratch_ / "run.clf.gz").string(), "--workers", "0", "--domain", own_domain()});
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_TRUE(read_file(scratch_ / "run" / "map.pb") == map_of(scratch_ / "run.clf.gz", "map"));
}

// The reader or mapper of a log is killed, so the log is read again: no scan is recorded twice.
TEST_F(Record, ALogThatIsReadAgainIsRecordedOnce) {
  use_udp_only();
  const fs::path log = scratch_ / "log.clf";
  write_log("floor", log);
  Program run(scratch_, "topogeo",
              {"run", "--log", log.string(), "--out", (scratch_ / "run").string(), "--record",
               (scratch_ / "run.clf").string(), "--workers", "0", "--domain", own_domain()});
  const auto send = [&run](const std::string& service, int signal_number) {
    for (const pid_t pid : run.services(service)) ::kill(pid, signal_number);
  };
  const auto wait_until = [&run](const std::function<bool()>& is_so) {
    ASSERT_TRUE(wait_for("a service to start or end", is_so)) << run.err();
  };
  // A service that is being restarted cannot be killed.
  const auto is_there = [&run](const std::string& service) {
    return !run.services(service).empty();
  };
  const std::vector<std::string> mapper_and_gateway = {"local_mapper", "sensor_gateway"};
  run.wait_for_progress(30);
  // The map is unfinished when all scans are recorded and the recorder has ended.
  send("localizer", SIGSTOP);
  for (const std::string& service : mapper_and_gateway) {
    send(service, SIGKILL);
    run.wait_for_error_text(service + " was killed by signal 9");
    wait_until([&] { return is_there(service); });
  }
  wait_until([&] { return !is_there("topogeo"); });
  // The run itself may have killed the gateway by then.
  for (const std::string& service : mapper_and_gateway) {
    wait_until([&] { return is_there(service); });
    send(service, SIGKILL);
  }
  run.wait_for_error_text("started again (2)");
  send("localizer", SIGCONT);
  ASSERT_EQ(run.wait(), 0) << run.err();
  EXPECT_TRUE(read_file(scratch_ / "run" / "map.pb") == map_of(log, "map"));
  record(log, scratch_ / "undisturbed.clf");
  EXPECT_TRUE(read_file(scratch_ / "run.clf") == read_file(scratch_ / "undisturbed.clf"));
}

/// Messages by topic, and the time of the last one of each.
std::map<std::string, std::pair<int, std::int64_t>> topics_of(const fs::path& file) {
  std::map<std::string, std::pair<int, std::int64_t>> topics;
  const auto source =
      recording::open_messages(file, [](const recording::Topic& /*topic*/) { return true; });
  recording::RawMessage message;
  while (source->next(message)) {
    auto& [count, last_ns] = topics[source->topics()[message.topic].name];
    ++count;
    last_ns = message.log_time_ns;
  }
  return topics;
}

// A replay without a rate is faster than mapping, so the recorder waits for the last results.
TEST_F(Record, ARunsPosesGraphAndGridAreWhole) {
  const fs::path log = scratch_ / "log.clf";
  write_log("room", log);
  int runs = 0;
  for (const std::string name : {"run.mcap", "bag"}) {
    // Records a run at this rate, and returns its number of poses.
    const auto poses_at = [&](const std::string& rate) {
      SCOPED_TRACE(testing::Message() << name << " at rate " << rate);
      const fs::path out = scratch_ / (std::to_string(++runs) + name);
      Program run(
          scratch_, "topogeo",
          {"run", "--log", log.string(), "--rate", rate, "--out", (scratch_ / "run").string(),
           "--record", out.string(), "--workers", "0", "--domain", own_domain()});
      EXPECT_EQ(run.wait(), 0) << run.err();
      EXPECT_THAT(run.err(), HasSubstr("with poses, the graph"));
      EXPECT_THAT(run.err(), testing::Not(HasSubstr("received no")));
      auto topics = topics_of(out);
      EXPECT_EQ(topics["/pose"].second, topics["/scan"].second);
      EXPECT_EQ(topics["/odom"].first, topics["/scan"].first);
      EXPECT_GE(topics["/map"].first, 1);
      EXPECT_GE(topics["/graph"].first, 1);
      return topics["/pose"].first;
    };
    EXPECT_GT(poses_at("lossless"), 0);
    // A recorder takes the present pose only: the slower the machine, the fewer poses. At a lower
    // rate there must be many.
    double rate = 20.0;
    EXPECT_TRUE(wait_for(name + " with many poses", [&] {
      rate /= 2.0;
      return poses_at(std::to_string(rate)) > 10 || HasFailure();
    }));
  }
}

TEST_F(Record, WhatCannotBeRecordedIsSaid) {
  Program nowhere(scratch_, "topogeo", {"record", "--out", "/no/such/folder/x.clf"});
  EXPECT_EQ(nowhere.wait(), 3);
  EXPECT_THAT(nowhere.err(), HasSubstr("/no/such/folder/x.clf"));
  Program silent(scratch_, "topogeo",
                 {"record", "--domain", own_domain(), "--out", (scratch_ / "x.clf").string()});
  ASSERT_TRUE(wait_for("the log to be begun", [&] { return fs::exists(scratch_ / "x.clf"); }));
  silent.send_signal(SIGINT);  // it may not have joined the domain yet
  EXPECT_EQ(silent.wait(), 1);
  EXPECT_THAT(silent.err(), HasSubstr("received no scan"));
}

class CheckLog : public CommandTest {
 protected:
  CheckLog() : CommandTest("check-log") {}
};

TEST_F(CheckLog, ExitCodeTellsCleanFromFaultyFromUnreadable) {
  const fs::path log = scratch_ / "log.clf";
  write_log("corridor", log);
  EXPECT_EQ(run({log.string()}), 0) << out_;
  EXPECT_THAT(out_, HasSubstr("no fault found"));
  std::ofstream(log, std::ios::app) << "FLASER 3 1 2\n";
  EXPECT_EQ(run({log.string()}), 1);
  EXPECT_THAT(out_, HasSubstr("truncated line"));
  EXPECT_EQ(run({(scratch_ / "missing.clf").string()}), 2);
  EXPECT_THAT(err_, HasSubstr("missing.clf"));
  EXPECT_EQ(run({log.string(), "--gap", "-1"}), 2);
}

TEST_F(CheckLog, JsonSaysTheSame) {
  const fs::path log = scratch_ / "log.clf";
  write_log("corridor", log);
  std::ofstream(log, std::ios::app) << "FLASER 3 1 2 \xff\xfe\n";
  ASSERT_EQ(run({"--json", log.string()}), 1);
  const auto json = nlohmann::json::parse(out_);
  EXPECT_EQ(json["faults"], 1);
  EXPECT_EQ(json["counts"]["truncated line"], 1);
  EXPECT_EQ(json["findings"].size(), 1U);
  EXPECT_GT(json["scans"], 10);
  EXPECT_EQ(json["laser_lines"], json["scans"].get<int>() + 1);
}

}  // namespace
}  // namespace topogeo::test
