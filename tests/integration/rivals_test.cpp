// Two map stores for one map or one robot, two localizers for one robot: the younger stops and
// gives the reason, and a killed one does not block its successor.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/status.h"

#include "program.hpp"

namespace topogeo::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

class Rivals : public testing::Test {
 protected:
  Rivals() {
    loop_.add<msg::ServiceStatus>(statuses_, [this](const msg::ServiceStatus& status, const auto&) {
      newest_[status.process_id()] = status;
    });
  }

  std::unique_ptr<Program> start(const std::string& name, std::vector<std::string> words) const {
    words.insert(words.end(), {"--domain", own_domain(), "--partition", partition_});
    return std::make_unique<Program>(scratch_, name, words);
  }
  std::unique_ptr<Program> start_store(const std::string& out,
                                       const std::string& robot = "robot") const {
    return start("map_store", {"--out", (scratch_ / out).string(), "--robot-id", robot});
  }
  static std::unique_ptr<Program> killed(std::unique_ptr<Program> program) {
    program->send_signal(SIGKILL);
    EXPECT_EQ(program->wait(), 128 + SIGKILL);
    return program;
  }

  [[nodiscard]] const msg::ServiceStatus* status(const Program& program) const {
    const auto found = newest_.find(static_cast<std::uint32_t>(program.pid()));
    return found == newest_.end() ? nullptr : &found->second;
  }
  bool works(const Program& program) {
    return wait_in_loop(loop_, "a service to work", [&] {
      const msg::ServiceStatus* const now = status(program);
      return now != nullptr && now->state() != msg::kServiceStarting;
    });
  }
  /// Pattern of the end of the name that a process of this test has: in a container, the number of
  /// its PID namespace follows (support::process_name).
  static std::string end_of_name(const Program& program) {
    return "-" + std::to_string(program.pid()) + "([.][0-9]+)?";
  }
  /// Expects that `second` fails and names `first`, which continues and reports `second` once.
  void expect_refused(Program& second, const Program& first, const std::string& name) {
    EXPECT_EQ(second.wait(), 1) << second.err();
    EXPECT_THAT(second.err(), HasSubstr("another " + name + " already runs for robot 'robot': "));
    EXPECT_THAT(second.err(), ContainsRegex(end_of_name(first) + "; this one stops"));
    EXPECT_TRUE(wait_in_loop(loop_, "the second to be reported",
                             [&] { return reports_second(first, name); }))
        << "faults: " << status(first)->fault_count() << ", " << status(first)->last_error();
    EXPECT_THAT(first.err(),
                ContainsRegex(end_of_name(second) + " was started for the same robot"));
    EXPECT_NE(status(first)->state(), msg::kServiceFailed);
  }
  bool reports_second(const Program& program, const std::string& name) const {
    return std::ranges::any_of(status(program)->faults(), [&](const msg::FaultCount& fault) {
      return fault.reason().to_string() == "second " + name && fault.count() == 1;
    });
  }

  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = "rivals" + std::to_string(std::random_device{}());
  Scratch scratch_;
  messaging::Participant participant_{[this] {
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
    options.partition = partition_;
    return options;
  }()};
  messaging::EventLoop loop_;
  messaging::Reader<msg::ServiceStatus> statuses_{participant_};
  std::map<std::uint32_t, msg::ServiceStatus> newest_;  // by process
};

TEST_F(Rivals, AFolderHasOneMapStore) {
  auto first = start_store("out");
  ASSERT_TRUE(works(*first));
  for (const char* robot : {"robot", "other"}) {
    auto second = start_store("out", robot);
    EXPECT_EQ(second->wait(), 3);
    EXPECT_THAT(second->err(),
                ContainsRegex("map[.]lock: held by process .*" + end_of_name(*first)));
  }
  auto elsewhere = start("map_store", {"--out", (scratch_ / "else").string(), "--database",
                                       (scratch_ / "out" / "map.sqlite").string()});
  EXPECT_EQ(elsewhere->wait(), 3);
  first = killed(std::move(first));
  const auto again = start_store("out");
  EXPECT_TRUE(works(*again)) << again->err();
}

TEST_F(Rivals, ARobotHasOneMapStore) {
  auto first = start_store("a");
  ASSERT_TRUE(works(*first));
  const auto of_another_robot = start_store("c", "other");
  auto second = start_store("b");
  expect_refused(*second, *first, "map_store");
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "b" / "map.pb"));
  EXPECT_TRUE(works(*of_another_robot));
  first = killed(std::move(first));
  const auto again = start_store("b");
  EXPECT_TRUE(works(*again)) << again->err();
}

TEST_F(Rivals, ARobotHasOneLocalizer) {
  auto first = start("localizer", {"--standalone"});
  ASSERT_TRUE(works(*first));
  const auto of_another_robot = start("localizer", {"--standalone", "--robot-id", "other"});
  auto second = start("localizer", {"--standalone"});
  expect_refused(*second, *first, "localizer");
  EXPECT_TRUE(works(*of_another_robot));
  EXPECT_EQ(status(*of_another_robot)->faults().size(), 0U);
  first = killed(std::move(first));
  const auto again = start("localizer", {"--standalone"});
  EXPECT_TRUE(works(*again)) << again->err();
}

}  // namespace
}  // namespace topogeo::test
