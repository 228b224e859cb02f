// Peers receive state, input, counters and faults of a service.
#include "topogeo/messaging/status_publisher.hpp"

#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "fixture.hpp"
#include "stranger_counts.hpp"

namespace topogeo::messaging {
namespace {

class Status : public TwoParticipants {
 protected:
  /// Runs the service's loop until `condition` holds for the newest received status.
  bool eventually_seen(const std::function<bool(const msg::ServiceStatus&)>& condition) {
    return test::wait_for("that status", [&] {
      loop_.run_for(std::chrono::milliseconds(5));
      reader_.take([&](const msg::ServiceStatus& status, const SampleInfo& info) {
        if (info.valid) seen_ = status;
      });
      return condition(seen_);
    });
  }

  EventLoop loop_;
  Reader<msg::ServiceStatus> reader_{receiver_};
  msg::ServiceStatus seen_;
  ServiceIdentity identity_{.service = "mapper", .instance = "", .robot_id = "r1", .version = "1"};
};

TEST_F(Status, StateCountersAndFaultsArrive) {
  StatusPublisher status(sender_, loop_, identity_);
  status.set_state(msg::kServiceRunning, "at work");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceRunning; }));
  EXPECT_EQ(seen_.service().to_string(), "mapper");
  EXPECT_EQ(seen_.message().to_string(), "at work");
  EXPECT_EQ(seen_.process_id(), static_cast<std::uint32_t>(::getpid()));
  EXPECT_EQ(seen_.fault_count(), 0U);

  EXPECT_EQ(seen_.inputs(), 0U);

  status.count_input("scan");
  status.count_input("scan");
  status.add_to_counter("scans");
  status.add_to_counter("scans", 2.0);
  status.fault("nan_range", "beam 7");
  status.fault("nan_range", "beam 8");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.fault_count() == 2; }));
  EXPECT_EQ(seen_.input().to_string(), "scan");
  EXPECT_EQ(seen_.inputs(), 2U);
  EXPECT_GE(seen_.input_age_s(), 0.0);
  ASSERT_EQ(seen_.counters().size(), 1U);
  EXPECT_EQ(seen_.counters()[0].name().to_string(), "scans");
  EXPECT_EQ(seen_.counters()[0].value(), 3.0);
  ASSERT_EQ(seen_.faults().size(), 1U);
  EXPECT_EQ(seen_.faults()[0].reason().to_string(), "nan_range");
  EXPECT_EQ(seen_.faults()[0].count(), 2U);

  // Inputs of the last seconds: after a pause of the machine there are none.
  EXPECT_TRUE(eventually_seen([&](const auto& s) {
    status.count_input("scan");
    return s.input_rate_per_s() > 0.0;
  }));
}

TEST_F(Status, LastWordIsStoppedUnlessTheStateIsFinal) {
  {
    StatusPublisher status(sender_, loop_, identity_);
    ASSERT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceStarting; }));
  }
  EXPECT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceStopped; }));
}

TEST_F(Status, IncompatibleQosIsAFault) {
  StatusPublisher status(sender_, loop_, identity_);
  const Writer<msg::Goal> writer(sender_, "command");
  loop_.add(writer);
  const Reader<msg::Goal> reader(receiver_);
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.fault_count() > 0; }));
  EXPECT_EQ(seen_.faults()[0].reason().to_string(), "incompatible_qos");
}

TEST_F(Status, LostSampleIsAFaultUnlessANewerStateReplacedIt) {
  StatusPublisher status(sender_, loop_, identity_);
  status.on_event({EventKind::kSampleLost, std::string(kTrajectorySegment), {}, 1, ""});
  status.on_event({EventKind::kSampleLost, std::string(kScan), {}, 1, ""});
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.fault_count() > 0; }));
  EXPECT_EQ(seen_.fault_count(), 1U);
  EXPECT_THAT(seen_.last_error().to_string(), testing::HasSubstr(std::string(kScan)));
}

TEST_F(Status, WaitsForIsSetWithTheStateAndGoneWithTheNext) {
  StatusPublisher status(sender_, loop_, identity_);
  status.wait_for("local maps");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceWaiting; }));
  EXPECT_EQ(seen_.waits_for().to_string(), "local maps");
  EXPECT_EQ(seen_.message().to_string(), "for local maps");
  status.set_state(msg::kServiceRunning);
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceRunning; }));
  EXPECT_EQ(seen_.waits_for().to_string(), "");
  status.set_waits_for("a map");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.waits_for() == "a map"; }));
  EXPECT_EQ(seen_.state(), msg::kServiceRunning);
}

TEST_F(Status, LastErrorStaysBesideTheStateAndAges) {
  StatusPublisher status(sender_, loop_, identity_);
  status.set_state(msg::kServiceRunning, "at work");
  status.fault("nan_range", "beam 7");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.last_error_age_s() > 0.2; }));
  EXPECT_EQ(seen_.last_error().to_string(), "nan_range: beam 7");
  EXPECT_EQ(seen_.message().to_string(), "at work");
  status.set_state(msg::kServiceFailed, "disk full");
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.state() == msg::kServiceFailed; }));
  EXPECT_EQ(seen_.last_error().to_string(), "disk full");
}

TEST_F(Status, TrafficDropsAndQueuesAreReported) {
  identity_.config_fingerprint = 77;
  StatusPublisher status(sender_, loop_, identity_);
  const Writer<msg::Goal> goals_out(receiver_);
  const Reader<msg::Goal> goals_in(sender_);
  std::size_t handled = 0;
  loop_.add<msg::Goal>(goals_in, [&](const msg::Goal&, const SampleInfo&) { ++handled; });
  Writer<msg::Route> routes(sender_);
  loop_.add(routes);
  ASSERT_TRUE(routes.write(message<msg::Route>()));
  Writer<msg::Goal> writer = goals_out;
  ASSERT_TRUE(writer.write(message<msg::Goal>()));
  status.add_drops("other robot");
  status.add_drops("other robot", 2);
  status.set_drops("stuck scan", 0);
  status.set_drops("bad checksum", 5);
  status.set_queue("tasks", 3, 64);
  const auto of = [&](const std::string& topic) -> const msg::TopicTraffic* {
    for (const msg::TopicTraffic& one : seen_.traffic()) {
      if (topic == one.topic().c_str()) return &one;
    }
    return nullptr;
  };
  ASSERT_TRUE(eventually_seen(
      [&](const auto&) { return of("goal") != nullptr && of("goal")->messages() == 1; }));
  EXPECT_EQ(handled, 1U);
  EXPECT_FALSE(of("goal")->sent());
  ASSERT_NE(of("route"), nullptr);
  EXPECT_TRUE(of("route")->sent());
  EXPECT_EQ(of("route")->messages(), 1U);
  ASSERT_NE(of("service_status"), nullptr) << "its own status is traffic, too";
  std::map<std::string, std::uint64_t> drops;
  for (const msg::FaultCount& drop : seen_.drops()) {
    drops[drop.reason().to_string()] = drop.count();
  }
  EXPECT_EQ(drops["bad checksum"], 5U);
  EXPECT_EQ(drops["other robot"], 3U);
  EXPECT_FALSE(drops.contains("stuck scan")) << "what never happened is left out";
  ASSERT_EQ(seen_.queues().size(), 1U);
  EXPECT_EQ(seen_.queues()[0].depth(), 3U);
  EXPECT_EQ(seen_.queues()[0].capacity(), 64U);
  EXPECT_EQ(seen_.config_fingerprint(), 77U);
}

TEST_F(Status, ForgedRemovalsAreAFault) {
  StatusPublisher status(sender_, loop_, identity_);
  count_forged_removals(2);
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.fault_count() > 0; }));
  EXPECT_EQ(seen_.faults()[0].reason(), "forged removal");
  EXPECT_EQ(seen_.faults()[0].count(), 1U) << "once for all since the last status";
  ASSERT_EQ(seen_.drops().size(), 1U);
  EXPECT_EQ(seen_.drops()[0].reason(), "forged_removal");
  EXPECT_EQ(seen_.drops()[0].count(), 2U);
}

TEST_F(Status, BoundsHold) {
  StatusPublisher status(sender_, loop_, identity_);
  for (int i = 0; i < 64; ++i) status.set_counter(std::to_string(i), i);
  EXPECT_THROW(status.set_counter("one more", 0.0), std::length_error);
  EXPECT_THROW(status.set_counter(std::string(49, 'c'), 0.0), std::invalid_argument);
  for (int i = 0; i < 40; ++i) status.fault(std::to_string(i), std::string(300, 'x'));
  for (int i = 0; i < 70; ++i) status.add_drops(std::to_string(i));
  for (int i = 0; i < 16; ++i) status.set_queue(std::to_string(i), 1);
  EXPECT_THROW(status.set_queue("one more", 1), std::length_error);
  EXPECT_THROW(status.set_queue(std::string(49, 'q'), 1), std::invalid_argument);
  ASSERT_TRUE(eventually_seen([](const auto& s) { return s.fault_count() == 40; }));
  EXPECT_EQ(seen_.drops().size(), 64U);
  EXPECT_EQ(seen_.counters().size(), 64U);
  EXPECT_EQ(seen_.faults().size(), 32U);
  EXPECT_EQ(seen_.last_error().size(), 255U);
  identity_.service = std::string(33, 's');
  EXPECT_THROW(StatusPublisher(sender_, loop_, identity_), std::invalid_argument);
}

}  // namespace
}  // namespace topogeo::messaging
