// How services report their health: status, metrics, `topogeo top` and `topogeo doctor`, between
// processes.
#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include <arpa/inet.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/status.h"
#include "topogeo/msg/type_supports.h"
#include "topogeo/service/status_metrics.hpp"
#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/version.hpp"

#include "program.hpp"

namespace topogeo::test {
namespace {

using std::chrono::milliseconds;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Matches;

class HealthTest : public testing::Test {
 protected:
  HealthTest() {
    use_udp_only();  // some programs are killed
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(domain_));
    options.partition = messaging::kAnyPartition;
    options.name = "health test";
    participant_.emplace(options);
    loop_.add<msg::ServiceStatus>(
        messaging::Reader<msg::ServiceStatus>(*participant_),
        [this](const msg::ServiceStatus& status, const messaging::SampleInfo& info) {
          statuses_[status.service().to_string()] = status;
          names_[info.instance] = status.service().to_string();
          for (const msg::Counter& counter : status.counters()) {
            counters_.insert(counter.name().to_string());
          }
        },
        [this](const messaging::SampleInfo& info) { gone_.insert(names_[info.instance]); });
  }

  std::unique_ptr<Program> start(const std::string& name, std::vector<std::string> words = {}) {
    words.insert(words.end(), {"--domain", domain_});
    return std::make_unique<Program>(scratch_, name, words);
  }
  /// Runs a command to its end.
  int run(std::vector<std::string> words, std::string& out) {
    words.insert(words.end(), {"--domain", domain_});
    Program program(scratch_, "topogeo", words);
    const int code = program.wait();
    out = program.out() + program.err();
    return code;
  }
  /// Repeats a command until it ends with `code` and prints `text`: on a busy machine a service may
  /// be found late or be silent for a moment. Returns its last output.
  std::string run_until(const std::vector<std::string>& words, int code, const std::string& text) {
    std::string out;
    EXPECT_TRUE(wait_for("topogeo " + words.front() + " to print '" + text + "'", [&] {
      return run(words, out) == code && out.find(text) != std::string::npos;
    })) << out;
    return out;
  }
  bool eventually(const std::string& what, const std::function<bool()>& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  bool eventually_in_state(const std::string& service, msg::ServiceState state) {
    return eventually(service + " to be in another state", [&] {
      return statuses_.contains(service) && statuses_[service].state() == state;
    });
  }

  Scratch scratch_;
  std::string domain_ = own_domain();
  std::optional<messaging::Participant> participant_;
  messaging::EventLoop loop_;
  std::map<std::string, msg::ServiceStatus> statuses_;  // by service
  std::map<messaging::Handle, std::string> names_;
  std::set<std::string> counters_;
  std::set<std::string> gone_;
};

// --- status

TEST_F(HealthTest, AKilledServiceIsLostToItsReaders) {
  const auto planner = start("planner");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  planner->send_signal(SIGKILL);
  ASSERT_TRUE(eventually("the planner to be lost", [&] { return gone_.contains("planner"); }));
}

// A later status command has never received from it, and discovery does not know it either.
TEST_F(HealthTest, AServiceThatIsFrozenIsNamedByAStatusThatIsAskedForLater) {
  set_longest_freeze(0);
  const auto planner = start("planner");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  planner->send_signal(SIGSTOP);
  EXPECT_THAT(run_until({"status"}, 1, "is stopped, and no status of it comes"),
              AllOf(HasSubstr("planner  silent"), HasSubstr("1 failed, lost, silent or deaf")));
  planner->send_signal(SIGCONT);
  EXPECT_THAT(run_until({"status"}, 0, "planner"), testing::Not(HasSubstr("planner  silent")));
}

// A later status command has never received from it.
TEST_F(HealthTest, AServiceThatDiedBeforeIsMissingWhereItIsExpected) {
  const auto planner = start("planner");
  const auto mapper = start("local_mapper");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  ASSERT_TRUE(eventually_in_state("local_mapper", msg::kServiceWaiting));
  const std::string host = support::host_name();
  EXPECT_THAT(run_until({"status", "--expect", "planner,local_mapper", "--host", host}, 0, ""),
              testing::Not(HasSubstr("missing")));
  planner->send_signal(SIGKILL);
  ASSERT_EQ(planner->wait(), 128 + SIGKILL);
  run_until({"status"}, 0, "");
  const std::string expected =
      run_until({"status", "--expect", "planner,local_mapper"}, 1, "local_mapper  waiting");
  EXPECT_THAT(expected, HasSubstr("planner       missing"));
}

TEST_F(HealthTest, StatusWaitsForAServiceThatComesLater) {
  Program status(scratch_, "topogeo",
                 {"status", "planner", "--wait-seconds", "600", "--domain", domain_});
  // A later service without the option gives up before this one.
  std::string out;
  EXPECT_EQ(run({"status", "planner"}, out), 1) << out;
  EXPECT_FALSE(status.ended());
  const auto planner = start("planner");
  EXPECT_EQ(status.wait(), 0) << status.err();
  EXPECT_THAT(status.out(), HasSubstr("planner"));
}

TEST_F(HealthTest, ServicesSayWhatTheyWaitForAndWhatConfigurationTheyHave) {
  const auto mapper = start("local_mapper");
  const auto planner = start("planner");
  ASSERT_TRUE(eventually_in_state("local_mapper", msg::kServiceWaiting));
  EXPECT_EQ(statuses_["local_mapper"].waits_for().to_string(), "the map store");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  ASSERT_TRUE(eventually("the planner to wait for a map",
                         [&] { return statuses_["planner"].waits_for() == "a map"; }));
  EXPECT_NE(statuses_["planner"].config_fingerprint(), 0U);
  EXPECT_EQ(statuses_["planner"].config_fingerprint(),
            statuses_["local_mapper"].config_fingerprint());
  EXPECT_THAT(statuses_["planner"].traffic(), testing::Not(IsEmpty()));
}

TEST_F(HealthTest, EveryCounterOfEveryServiceIsAMetric) {
  std::filesystem::create_directories(scratch_ / "ports");
  const std::string laser = (scratch_ / "ports" / "laser").string();
  const std::string base = (scratch_ / "ports" / "base").string();
  std::ofstream(scratch_ / "devices.yaml")
      << "laser:\n  port: " << laser << "\nbase:\n  port: " << base << "\n";
  const std::string log = (scratch_ / "drive.clf").string();
  write_log("short", log);
  // A short run may end before all of its services are heard; then it is repeated.
  const auto are_heard = [&] {
    for (const char* service : {"planner", "localizer", "local_mapper", "map_store"}) {
      if (!statuses_.contains(service)) return false;
    }
    return counters_.contains("tasks_sent") && counters_.contains("stored_local_maps");
  };
  for (int n = 0; !are_heard(); ++n) {
    const std::string out = (scratch_ / ("out" + std::to_string(n))).string();
    const auto run = start("topogeo", {"run", "--log", log, "--out", out, "--workers", "1"});
    ASSERT_TRUE(eventually("the end of the run", [&] { return run->ended(); }));
    ASSERT_EQ(run->wait(), 0) << run->err();
  }
  const auto simulator =
      start("simulator", {"--world", std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml",
                          "--laser-port", laser, "--base-port", base});
  const auto navigator = start("navigator");
  const auto worker = start("ga_worker");
  const auto gateway = start("sensor_gateway", {"--devices", (scratch_ / "devices.yaml").string()});
  ASSERT_TRUE(eventually("the counters of the gateway",
                         [&] { return counters_.contains("scan_latency_ms"); }));
  for (const char* service : {"simulator", "navigator", "planner", "ga_worker", "localizer",
                              "local_mapper", "map_store", "sensor_gateway"}) {
    EXPECT_TRUE(eventually("all services", [&] { return statuses_.contains(service); })) << service;
  }
  for (const char* counter : {"tasks_sent", "stored_local_maps", "time_s", "slots", "commands"}) {
    EXPECT_TRUE(eventually("all counters", [&] { return counters_.contains(counter); })) << counter;
  }
  for (const std::string& counter : counters_) {
    EXPECT_NE(service::find_metric(counter), nullptr)
        << "'" << counter << "': declare it in services/common/src/counter_metrics.cpp";
  }
}

// --- metrics

/// Head and body of a service's answer at /metrics.
std::string scrape(std::uint16_t port) {
  const support::FileDescriptor line(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  sockaddr_in peer{};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(port);
  peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(line.get(), reinterpret_cast<const sockaddr*>(&peer), sizeof peer) != 0) return {};
  const std::string request = "GET /metrics HTTP/1.0\r\n\r\n";
  if (::send(line.get(), request.data(), request.size(), 0) < 0) return {};
  std::string answer;
  std::array<char, 4096> piece{};
  for (ssize_t n = 0; (n = ::recv(line.get(), piece.data(), piece.size(), 0)) > 0;) {
    answer.append(piece.data(), static_cast<std::size_t>(n));
  }
  return answer;
}

TEST_F(HealthTest, MetricsAreTheNumbersOfTheStatus) {
  const auto planner = start("planner", {"--metrics-port", "0"});
  planner->wait_for_error_text("/metrics");
  const std::string log = planner->err();
  const std::string before = "http://127.0.0.1:";
  const auto port =
      static_cast<std::uint16_t>(std::stoul(log.substr(log.find(before) + before.size())));
  messaging::Writer<msg::Goal> goals(*participant_);
  ASSERT_TRUE(eventually("the planner", [&] { return goals.matched() > 0; }));
  msg::Goal goal;
  messaging::set_header(goal, "robot", 0, 0);
  goal.goal_id(1);
  ASSERT_TRUE(goals.write(goal));
  EXPECT_TRUE(eventually("the goal in the metrics", [&] {
    return scrape(port).find("topogeo_goals_total{service=\"planner\",robot=\"robot\"") !=
               std::string::npos &&
           scrape(port).find("direction=\"received\"} 1") != std::string::npos;
  })) << scrape(port);
  EXPECT_THAT(scrape(port), AllOf(HasSubstr("topogeo_service_state"), HasSubstr("200 OK")));
}

TEST_F(HealthTest, ServicesGiveNoMetricsUnlessAskedAndRefuseATakenPort) {
  const auto planner = start("planner");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  EXPECT_THAT(planner->err(), testing::Not(HasSubstr("/metrics")));
  const auto first = start("navigator", {"--metrics-port", "0"});
  first->wait_for_error_text("/metrics");
  const std::string log = first->err();
  const std::string before = "http://127.0.0.1:";
  const std::size_t begin = log.find(before) + before.size();
  const std::string port = log.substr(begin, log.find('/', begin) - begin);
  const auto second = start("planner", {"--metrics-port", port});
  EXPECT_EQ(second->wait(), 1);
  EXPECT_THAT(second->err(), HasSubstr("metrics: cannot listen on 127.0.0.1, port " + port));
}

// --- top

TEST_F(HealthTest, TopShowsThePool) {
  std::string out;
  EXPECT_EQ(run({"top", "--once"}, out), 1);
  EXPECT_THAT(out, HasSubstr("no search worker is alive on domain " + domain_));
  const auto worker = start("ga_worker", {"--slots", "3", "--name", "pc-2"});
  const auto localizer = start("localizer", {"--standalone"});
  ASSERT_TRUE(eventually_in_state("ga_worker", msg::kServiceRunning));
  ASSERT_TRUE(eventually("the localizer to know the worker", [&] {
    for (const msg::Counter& counter : statuses_["localizer"].counters()) {
      if (counter.name() == "workers" && counter.value() == 1.0) return true;
    }
    return false;
  }));
  // On a busy machine, the status of one of the two may come too late for a command.
  ASSERT_TRUE(wait_for("topogeo top to list worker and robot", [&] {
    return run({"top", "--once"}, out) == 0 &&
           Matches(AllOf(HasSubstr("1 worker, 3 slots"), HasSubstr("pc-2"), HasSubstr("ROBOT")))(
               out);
  })) << out;
  nlohmann::json pool;
  ASSERT_TRUE(wait_for("topogeo top to give worker and robot", [&] {
    if (run({"top", "--once", "--json"}, out) != 0) return false;
    pool = nlohmann::json::parse(out);
    return pool["workers"].size() == 1 && pool["robots"].size() == 1;
  })) << out;
  EXPECT_EQ(pool["workers"][0]["name"], "pc-2");
  EXPECT_EQ(pool["workers"][0]["fault_count"], 0);
  EXPECT_EQ(pool["robots"][0]["workers"], 1.0);
  EXPECT_EQ(pool["total"]["slots"], 3);
}

// --- doctor

/// The texts of the problems that the report of a check has.
std::vector<std::string> problems_of(const std::string& report, const std::string& check) {
  std::vector<std::string> texts;
  const auto parsed = nlohmann::json::parse(report);
  for (const auto& finding : parsed["findings"]) {
    if (finding["check"] == check && finding["severity"] == "problem") {
      texts.push_back(finding["what"]);
    }
  }
  return texts;
}

/// Programs started from here on discover each other by a server, which does not run.
class DeadServer {
 public:
  DeadServer() { ::setenv("ROS_DISCOVERY_SERVER", kAddress, 1); }
  DeadServer(const DeadServer&) = delete;
  DeadServer& operator=(const DeadServer&) = delete;
  ~DeadServer() { ::unsetenv("ROS_DISCOVERY_SERVER"); }

  static constexpr const char* kAddress = "127.0.0.1:9";  // the port of discarded messages
};

TEST_F(HealthTest, ADiscoveryServerThatDoesNotAnswerIsNamed) {
  const DeadServer server;
  const std::string log = scratch_ / "log.clf";
  write_log("corridor", log);
  Program run(scratch_, "topogeo",
              {"run", "--log", log, "--out", scratch_ / "out", "--workers", "0"});
  run.wait_for_error_text(std::string("no discovery server answers at ") + DeadServer::kAddress);
  run.send_signal(SIGINT);
  Program doctor(scratch_, "topogeo", {"doctor", "--json"});
  EXPECT_EQ(doctor.wait(), 1) << doctor.out();
  EXPECT_THAT(doctor.out(), HasSubstr("no discovery server answers at"));
}

TEST_F(HealthTest, DoctorNamesAFolderThatCannotBeWritten) {
  std::ofstream(scratch_ / "file") << "x";
  std::string out;
  EXPECT_EQ(
      run({"doctor", "--alone", "--json", "--map", (scratch_ / "file" / "map").string()}, out), 1);
  EXPECT_THAT(problems_of(out, "map folder"), testing::SizeIs(1)) << out;
  run({"doctor", "--alone", "--json", "--map", (scratch_ / "map").string()}, out);
  EXPECT_THAT(problems_of(out, "map folder"), IsEmpty()) << out;
}

TEST_F(HealthTest, DoctorHasNothingToSayOfServicesThatFit) {
  const auto planner = start("planner");
  const auto mapper = start("local_mapper");
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  ASSERT_TRUE(eventually_in_state("local_mapper", msg::kServiceWaiting));
  std::string out;
  // A status that a busy machine delivers late looks like that of a clock that is behind.
  EXPECT_TRUE(wait_for("statuses that arrive in time", [&] {
    run({"doctor", "--json"}, out);
    for (const char* check : {"wire contract", "versions", "configuration", "QoS"}) {
      EXPECT_THAT(problems_of(out, check), IsEmpty()) << check;
    }
    return HasFailure() || problems_of(out, "clocks").empty();
  })) << out;
}

TEST_F(HealthTest, DoctorFindsOtherConfigurations) {
  std::ofstream(scratch_ / "other.yaml") << "stop:\n  distance_m: 0.5\n";
  const auto planner = start("planner");
  const auto mapper = start("local_mapper", {"--config", (scratch_ / "other.yaml").string()});
  ASSERT_TRUE(eventually_in_state("planner", msg::kServiceRunning));
  ASSERT_TRUE(eventually_in_state("local_mapper", msg::kServiceWaiting));
  const std::string out = run_until({"doctor", "--json"}, 1, " configurations");
  EXPECT_THAT(problems_of(out, "configuration"),
              testing::ElementsAre(HasSubstr("robot robot have 2 configurations")));
}

TEST_F(HealthTest, DoctorFindsAWrongClockAndAnotherVersion) {
  constexpr std::int64_t kHour_ns = 3'600'000'000'000;
  messaging::Writer<msg::ServiceStatus> statuses(*participant_);
  msg::ServiceStatus status;
  messaging::set_header(status, "robot", 0, 0);
  messaging::set_service(status, "planner", "late-1");
  messaging::set_text(status.host(), "late", "host");
  messaging::set_text(status.version(), "0.0.1", "version");
  // Status of a service whose clock is an hour behind.
  loop_.add_timer(milliseconds(100), [&] {
    status.stamp_ns(support::wall_clock_ns() - kHour_ns);
    ASSERT_TRUE(statuses.write(status));
  });
  std::thread publishing([&] { loop_.run(); });
  const std::string out = run_until({"doctor", "--json"}, 1, "the clock of late is ");
  loop_.stop();
  publishing.join();
  // The transport delay of a status adds to the difference.
  EXPECT_THAT(problems_of(out, "clocks"),
              testing::ElementsAre(HasSubstr("the clock of late is 36")));
  EXPECT_THAT(problems_of(out, "versions"),
              testing::ElementsAre(HasSubstr("planner on late run version 0.0.1")));
}

TEST_F(HealthTest, DoctorFindsPeersThatCannotBeConnected) {
  const messaging::Writer<msg::Goal> goals(*participant_, "command");  // not as readers want them
  const auto planner = start("planner");
  ASSERT_TRUE(
      eventually("a fault of the planner", [&] { return statuses_["planner"].fault_count() > 0; }));
  const std::string out = run_until({"doctor", "--json"}, 1, "goal: writer 'health test'");
  EXPECT_THAT(problems_of(out, "QoS"), Contains(HasSubstr("goal: writer 'health test'")));
  EXPECT_THAT(problems_of(out, "QoS"), Contains(HasSubstr("planner on")));
}

TEST_F(HealthTest, DoctorFindsAnotherWireVersion) {
  namespace dds = eprosima::fastdds::dds;
  auto* factory = dds::DomainParticipantFactory::get_instance();
  dds::DomainParticipantQos qos;
  qos.name("robot/old_planner");
  dds::DomainParticipant* old =
      factory->create_participant(static_cast<std::uint32_t>(std::stoul(domain_)), qos);
  ASSERT_NE(old, nullptr);
  const dds::TypeSupport type(new msg::GoalPubSubType);
  type.register_type(old);
  dds::Topic* topic = old->create_topic("topogeo/v9/goal", type.get_type_name(), {});
  dds::Publisher* publisher = old->create_publisher({});
  ASSERT_NE(publisher->create_datawriter(topic, {}), nullptr);
  const std::string out = run_until({"doctor", "--json"}, 1, "speak version 9");
  EXPECT_THAT(problems_of(out, "wire contract"),
              testing::ElementsAre(HasSubstr("'robot/old_planner' speak version 9")));
  old->delete_contained_entities();
  factory->delete_participant(old);
}

}  // namespace
}  // namespace topogeo::test
