// A service accepts the messages of its robot that its handlers can use.
#include "topogeo/service/service.hpp"

#include <vector>

#include "topogeo/service/sole_service.hpp"

#include "messaging/fixture.hpp"

namespace topogeo::service {
namespace {

Setup setup_in(const std::string& partition) {
  Setup setup;
  setup.name = "mapper";
  setup.options.partition = partition;
  return setup;
}

template <class T>
T message_of(const std::string& robot_id, std::uint64_t sequence_number = 0) {
  T result;
  messaging::set_header(result, robot_id, 1'000, sequence_number);
  return result;
}

class ServiceTest : public ::testing::Test {
 protected:
  /// Runs the service until `condition` holds.
  bool run_until(const std::string& what, const std::function<bool()>& condition) {
    return test::wait_for(what, [&] {
      service_.loop().run_for(std::chrono::milliseconds(5));
      statuses_.take([this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
        if (info.valid) status_ = status;
      });
      return condition();
    });
  }

  [[nodiscard]] std::uint64_t drops(const std::string& reason) const {
    for (const msg::FaultCount& drop : status_.drops()) {
      if (reason == drop.reason().c_str()) return drop.count();
    }
    return 0;
  }

  std::string partition_ = messaging::random_partition();
  Service service_{setup_in(partition_)};
  messaging::Participant peer_{messaging::options_in(partition_)};
  messaging::Reader<msg::ServiceStatus> statuses_{peer_};
  msg::ServiceStatus status_;
};

// A gateway would wait forever for a program that announces more topics than it reads.
TEST_F(ServiceTest, SubscribesToWhatItAnnouncesToRead) {
  service_.subscribe<msg::Scan>([](const msg::Scan&) {}, {.read_with = {messaging::kOdometry}});
  EXPECT_THROW(service_.run(), std::logic_error);
  service_.subscribe<msg::Odometry>([](const msg::Odometry&) {});
  service_.loop().stop();
  EXPECT_NO_THROW(service_.run());
}

TEST_F(ServiceTest, HandlersGetTheMessagesOfTheRobotAlone) {
  std::vector<std::uint64_t> goals;
  std::vector<std::string> closures;
  service_.subscribe<msg::Goal>([&](const msg::Goal& goal) { goals.push_back(goal.goal_id()); });
  service_.subscribe<msg::LoopClosures>(
      [&](const msg::LoopClosures& message, const messaging::SampleInfo& info) {
        EXPECT_TRUE(info.valid);
        closures.push_back(message.robot_id().to_string());
      },
      {.any_robot = true});
  messaging::Writer<msg::Goal> goal_writer(peer_);
  messaging::Writer<msg::LoopClosures> closure_writer(peer_);
  auto goal = message_of<msg::Goal>("another");
  goal.goal_id(1);
  ASSERT_TRUE(goal_writer.write(goal));
  goal = message_of<msg::Goal>("robot");
  goal.goal_id(2);
  ASSERT_TRUE(goal_writer.write(goal));
  ASSERT_TRUE(closure_writer.write(message_of<msg::LoopClosures>("another")));

  EXPECT_TRUE(run_until("the messages of the robot", [&] {
    return goals.size() == 1 && closures.size() == 1 && drops("other robot") == 1;
  }));
  EXPECT_EQ(goals, std::vector<std::uint64_t>{2});
  EXPECT_EQ(closures, std::vector<std::string>{"another"});
}

TEST_F(ServiceTest, InvalidMessageIsAFaultNamedAfterTheTopic) {
  service_.subscribe<msg::LocalMap>(
      [](const msg::LocalMap&) { throw std::invalid_argument("points: no finite number"); });
  messaging::Writer<msg::LocalMap> writer(peer_);
  ASSERT_TRUE(writer.write(message_of<msg::LocalMap>("robot", 17)));
  ASSERT_TRUE(run_until("a fault", [&] { return status_.fault_count() == 1; }));
  EXPECT_EQ(status_.faults()[0].reason().to_string(), "invalid local map");
  EXPECT_EQ(drops("invalid local map"), 1U);
  EXPECT_EQ(status_.last_error().to_string(),
            "invalid local map: number 17: points: no finite number");
}

TEST_F(ServiceTest, MainInputIsCountedInTheStatus) {
  service_.subscribe<msg::LocalMap>([](const msg::LocalMap&) {}, {.main_input = true});
  service_.subscribe<msg::Goal>([](const msg::Goal&) {});
  messaging::Writer<msg::LocalMap> maps(peer_);
  messaging::Writer<msg::Goal> goals(peer_);
  ASSERT_TRUE(maps.write(message_of<msg::LocalMap>("robot")));
  auto other = message_of<msg::LocalMap>("another");
  other.session(5);
  ASSERT_TRUE(maps.write(other));
  ASSERT_TRUE(goals.write(message_of<msg::Goal>("robot")));
  EXPECT_TRUE(run_until("the input to be counted",
                        [&] { return status_.inputs() == 1 && drops("other robot") == 1; }));
  EXPECT_EQ(status_.input().to_string(), "local_map");
}

TEST_F(ServiceTest, OtherErrorsOfAHandlerEndTheService) {
  service_.subscribe<msg::Goal>([](const msg::Goal&) { throw std::runtime_error("no memory"); });
  messaging::Writer<msg::Goal> writer(peer_);
  ASSERT_TRUE(writer.write(message_of<msg::Goal>("robot")));
  EXPECT_THROW(service_.run(), std::runtime_error);
  EXPECT_EQ(service_.status().state(), msg::kServiceFailed);
}

TEST_F(ServiceTest, DisposedInstancesAreReported) {
  int tiles = 0;
  int gone = 0;
  service_.subscribe<msg::GridTile>([&](const msg::GridTile&) { ++tiles; }, {},
                                    [&](const messaging::SampleInfo& info) {
                                      EXPECT_EQ(info.state, messaging::InstanceState::kDisposed);
                                      ++gone;
                                    });
  messaging::Writer<msg::GridTile> writer(peer_);
  ASSERT_TRUE(writer.write(message_of<msg::GridTile>("robot")));
  ASSERT_TRUE(run_until("the tile", [&] { return tiles == 1; }));
  writer.dispose(message_of<msg::GridTile>("robot"));
  EXPECT_TRUE(run_until("the disposal", [&] { return gone == 1; }));
}

TEST_F(ServiceTest, AddresseeAndRoleAreThoseOfTheSubscription) {
  std::vector<std::uint64_t> tasks;
  service_.subscribe<msg::MatchTasks>(
      [&](const msg::MatchTasks& task) { tasks.push_back(task.sequence_number()); },
      {.addressee = "me", .any_robot = true});
  int scans = 0;
  service_.subscribe<msg::Scan>([&](const msg::Scan&) { ++scans; },
                                {.role = std::string(messaging::kReplayRole)});
  messaging::Writer<msg::MatchTasks> task_writer(peer_);
  messaging::Writer<msg::Scan> scan_writer(peer_, messaging::kReplayRole);
  ASSERT_TRUE(messaging::wait_for_peers(task_writer));
  ASSERT_TRUE(messaging::wait_for_peers(scan_writer));
  for (const auto& [who, id] : {std::pair{"you", 1U}, std::pair{"me", 2U}}) {
    auto task = message_of<msg::MatchTasks>("any");
    messaging::set_worker_id(task, who);
    task.sequence_number(id);
    ASSERT_TRUE(task_writer.write(task));
  }
  ASSERT_TRUE(scan_writer.write(message_of<msg::Scan>("robot")));
  EXPECT_TRUE(run_until("the scan and the task", [&] { return scans == 1 && !tasks.empty(); }));
  EXPECT_EQ(tasks, std::vector<std::uint64_t>{2});
}

TEST_F(ServiceTest, AdvertisedWriterReachesAPeerAndItsEventsAreWatched) {
  messaging::Writer<msg::Route> writer = service_.advertise<msg::Route>();
  const messaging::Reader<msg::Route> reader(peer_);
  ASSERT_TRUE(messaging::wait_for_peers(reader));
  EXPECT_TRUE(service_.send(writer, message_of<msg::Route>("robot"), "route"));

  const messaging::Writer<msg::Goal> odd = service_.advertise<msg::Goal>("command");
  const messaging::Reader<msg::Goal> strict(peer_);  // stricter than the role command
  EXPECT_TRUE(
      run_until("incompatible settings to be a fault", [&] { return status_.fault_count() > 0; }));
  EXPECT_EQ(status_.faults()[0].reason().to_string(), "incompatible_qos");
}

/// Another service with the same name and robot, whose clock is far off.
msg::ServiceStatus rival_of(const msg::ServiceStatus& own, msg::ServiceState state) {
  msg::ServiceStatus rival = own;
  messaging::set_service(rival, own.service().to_string(), "elsewhere-1");
  rival.state(state);
  rival.started_ns(own.started_ns() + (state == msg::kServiceStarting ? -1 : 1) * 1'000'000'000LL);
  return rival;
}

TEST_F(ServiceTest, WhoStartsStopsForOneThatWorks) {
  messaging::Writer<msg::ServiceStatus> writer(peer_);
  ASSERT_TRUE(writer.write(rival_of(service_.status().message(), msg::kServiceRunning)));
  try {
    const SoleService sole(service_);
    service_.run();  // on a busy machine the status comes only now, and the younger one stops then
    FAIL() << "two of them work";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "another mapper already runs for robot 'robot': elsewhere-1; this one stops");
  }
  EXPECT_EQ(service_.status().state(), msg::kServiceFailed);
}

TEST_F(ServiceTest, WhoWorksCountsThoseThatStartOnce) {
  const SoleService sole(service_);
  service_.status().set_state(msg::kServiceRunning);
  messaging::Writer<msg::ServiceStatus> writer(peer_);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(writer.write(rival_of(service_.status().message(), msg::kServiceStarting)));
  }
  ASSERT_TRUE(run_until("the fault of a second service", [&] {
    return status_.service() == "mapper" && status_.fault_count() > 0;
  }));
  EXPECT_EQ(status_.fault_count(), 1U);
  EXPECT_EQ(status_.faults()[0].reason().to_string(), "second mapper");
  EXPECT_EQ(status_.state(), msg::kServiceRunning);
}

}  // namespace
}  // namespace topogeo::service
