// The table of `topogeo status` for given statuses and times, without DDS.
#include "topogeo/live/status_table.hpp"

#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "topogeo/messaging/message.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

const StatusTable::Clock::time_point kNow{std::chrono::hours(1)};

messaging::SampleInfo info_of(std::uint8_t number) {
  messaging::SampleInfo info;
  info.valid = true;
  info.instance.bytes[0] = number;
  return info;
}

msg::ServiceStatus status_of(const std::string& service, msg::ServiceState state,
                             const std::string& message = {}) {
  msg::ServiceStatus status;
  messaging::set_header(status, "robot", 0, 0);
  messaging::set_service(status, service, service + "-1");
  messaging::set_text(status.host(), "pc", "host");
  messaging::set_text(status.version(), "1.2", "version");
  messaging::set_text(status.message(), message, "message");
  status.process_id(4321);
  status.state(state);
  return status;
}

msg::ServiceStatus fed(msg::ServiceStatus status, const std::string& input, double rate_per_s,
                       double age_s) {
  messaging::set_text(status.input(), input, "input");
  status.inputs(100);
  status.input_rate_per_s(rate_per_s);
  status.input_age_s(age_s);
  return status;
}

std::size_t widest_line(const std::string& text) {
  std::istringstream lines(text);
  std::size_t widest = 0;
  for (std::string line; std::getline(lines, line);) widest = std::max(widest, line.size());
  return widest;
}

void give_counter(msg::ServiceStatus& status, const std::string& name, double value) {
  msg::Counter counter;
  messaging::set_text(counter.name(), name, "counter");
  counter.value(value);
  status.counters().push_back(counter);
}

TEST(StatusTable, NamesWhoIsShortOfCpuAndWhere) {
  StatusTable table;
  msg::ServiceStatus navigator = status_of("navigator", msg::kServiceRunning, "idle: no goal");
  give_counter(navigator, "timer_delay_s", 0.42);
  give_counter(navigator, "cpu_short", 0.0);
  table.update(navigator, info_of(1), kNow);
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("short")));
  navigator.counters()[1].value(1.0);
  table.update(navigator, info_of(1), kNow);
  const std::string text = table.text(kNow, 200);
  EXPECT_THAT(text, HasSubstr("idle: no goal; the CPU is short: timers fire up to 0.4 s late\n"));
  EXPECT_THAT(text, HasSubstr("the CPU of pc is short: see topogeo doctor\n"));
  EXPECT_TRUE(table.healthy(kNow)) << "it works, though late";
}

TEST(StatusTable, WithoutAnyServiceSaysSo) {
  EXPECT_THAT(StatusTable{}.text(kNow), EndsWith("no service is alive\n"));
}

TEST(StatusTable, ShowsOneLineForEachService) {
  StatusTable table;
  table.update(fed(status_of("sensor_gateway", msg::kServiceRunning), "scan", 12.34, 0.05),
               info_of(1), kNow);
  msg::ServiceStatus localizer =
      fed(status_of("localizer", msg::kServiceWaiting, "for local maps"), "local_map", 2.0, 30.0);
  localizer.fault_count(3);
  table.update(localizer, info_of(2), kNow);
  table.update(status_of("planner", msg::kServiceRunning), info_of(3), kNow);
  EXPECT_EQ(table.text(kNow + milliseconds(500)),
            "SERVICE         STATE    INPUT/s    AGE  FAULTS  REASON\n"
            "localizer       waiting      2.0   30 s       3  for local maps\n"
            "planner         running        -      -       0\n"
            "sensor_gateway  running       12  0.6 s       0\n"
            "3 services, none failed, lost, silent or deaf, 3 faults\n");
  EXPECT_TRUE(table.healthy(kNow));
}

TEST(StatusTable, StaysWithinEightyColumnsWhateverTheNames) {
  StatusTable table;
  const std::string text_255 = "the results cannot be written: " + std::string(150, 'x') +
                               " is on a disk that is full, and it will be tried again soon";
  for (int i = 0; i < 2; ++i) {
    msg::ServiceStatus status = status_of("calibration_gateway", msg::kServiceFailed, text_255);
    messaging::set_service(status, "calibration_gateway", "instance-" + std::to_string(i));
    status.process_id(4'000'000 + static_cast<std::uint32_t>(i));
    status.fault_count(99'999);
    table.update(fed(status, "scan", 1234.5, 7300.0), info_of(static_cast<std::uint8_t>(i)), kNow);
  }
  msg::ServiceStatus other = status_of("map_store", msg::kServiceRunning);
  messaging::set_text(other.host(), std::string(60, 'h'), "host");
  messaging::set_robot_id(other, std::string(32, 'r'));
  table.update(other, info_of(9), kNow);
  const std::string text = table.text(kNow);
  EXPECT_LE(widest_line(text), 80U) << text;
  EXPECT_THAT(text, HasSubstr("PID"));
  EXPECT_THAT(text, HasSubstr("ROBOT"));
  EXPECT_THAT(text, HasSubstr("HOST"));
  EXPECT_THAT(text, HasSubstr("tried again soon")) << "reasons are not cut";
}

TEST(StatusTable, LeavesOutWhatIsTheSameEverywhere) {
  StatusTable table;
  table.update(status_of("planner", msg::kServiceRunning), info_of(1), kNow);
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("HOST")));
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("ROBOT")));
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("PID")));
  msg::ServiceStatus of_any = status_of("ga_worker", msg::kServiceRunning);
  messaging::set_robot_id(of_any, "");
  table.update(of_any, info_of(2), kNow);
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("ROBOT"))) << "a service of every robot is of none";
}

TEST(StatusTable, FailedAndSilentServicesAreUnwell) {
  StatusTable table;
  table.update(status_of("planner", msg::kServiceRunning, "at work"), info_of(1), kNow);
  EXPECT_TRUE(table.healthy(kNow + milliseconds(1400)));
  EXPECT_FALSE(table.healthy(kNow + seconds(3)));
  EXPECT_THAT(table.text(kNow + seconds(3)), HasSubstr("silent"));
  EXPECT_THAT(table.text(kNow + seconds(3)), HasSubstr("no status for 3.0 s; before: at work"));
  EXPECT_THAT(table.text(kNow + seconds(3)),
              HasSubstr("1 service, 1 failed, lost, silent or deaf"));
  table.update(status_of("planner", msg::kServiceFailed, "disk full"), info_of(1), kNow);
  EXPECT_FALSE(table.healthy(kNow));
  EXPECT_THAT(table.text(kNow), HasSubstr("failed"));
  EXPECT_THAT(table.text(kNow), HasSubstr("disk full"));
}

TEST(StatusTable, KilledServiceStaysAsLostForAWhile) {
  StatusTable table;
  table.update(status_of("planner", msg::kServiceRunning), info_of(1), kNow);
  table.remove(info_of(1));
  EXPECT_THAT(table.text(kNow + seconds(1)), HasSubstr("lost"));
  EXPECT_FALSE(table.healthy(kNow + seconds(1)));
  table.forget(kNow + seconds(9));
  EXPECT_FALSE(table.empty());
  table.forget(kNow + seconds(11));
  EXPECT_TRUE(table.empty());
}

TEST(StatusTable, ExpectedServiceThatIsNotThereIsMissing) {
  StatusTable table;
  table.expect({"planner", "map_store", "planner"});
  EXPECT_FALSE(table.healthy(kNow));
  EXPECT_THAT(table.missing(), testing::ElementsAre("planner", "map_store"));
  table.update(status_of("planner", msg::kServiceRunning), info_of(1), kNow);
  table.update(status_of("localizer", msg::kServiceRunning), info_of(2), kNow);
  EXPECT_EQ(table.text(kNow),
            "SERVICE    STATE    INPUT/s  AGE  FAULTS  REASON\n"
            "localizer  running        -    -       0\n"
            "planner    running        -    -       0\n"
            "map_store  missing        -    -       -  expected, and not found\n"
            "2 services, 1 missing, none failed, lost, silent or deaf, 0 faults\n");
  EXPECT_THAT(table.details(kNow), HasSubstr("\n\nmap_store  missing\n  reason     expected"));
  const auto json = nlohmann::json::parse(table.json(kNow));
  ASSERT_EQ(json.size(), 3U);
  EXPECT_EQ(json[2], nlohmann::json::parse(R"({"service": "map_store", "state": "missing",
                                               "message": "expected, and not found"})"));
  EXPECT_FALSE(table.healthy(kNow));
  table.update(status_of("map_store", msg::kServiceWaiting), info_of(3), kNow);
  EXPECT_TRUE(table.healthy(kNow));
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("missing")));
}

TEST(StatusTable, ExpectedServiceThatEndsIsMissingAndOneThatDiesIsLost) {
  StatusTable table;
  table.expect({"planner"});
  table.update(status_of("planner", msg::kServiceRunning), info_of(1), kNow);
  table.remove(info_of(1));
  EXPECT_THAT(table.missing(), testing::IsEmpty());
  EXPECT_THAT(table.text(kNow), HasSubstr("lost"));
  table.forget(kNow + seconds(11));
  EXPECT_THAT(table.missing(), testing::ElementsAre("planner"));
  table.update(status_of("planner", msg::kServiceRunning), info_of(2), kNow);
  table.update(status_of("planner", msg::kServiceStopped), info_of(2), kNow);
  EXPECT_THAT(table.missing(), testing::ElementsAre("planner"));
}

TEST(StatusTable, UnitsOfThisHostThatDoNotRunAreListed) {
  StatusTable table;
  table.update(status_of("planner", msg::kServiceRunning), info_of(1), kNow);
  table.show_units({{"topogeo-map-store", false}, {"topogeo-web", true}});
  EXPECT_FALSE(table.healthy(kNow));
  EXPECT_EQ(
      table.text(kNow, 120),
      "SERVICE            STATE       INPUT/s  AGE  FAULTS  REASON\n"
      "planner            running           -    -       0\n"
      "topogeo-map-store  failed            -    -       -  see journalctl -u topogeo-map-store\n"
      "topogeo-web        restarting        -    -       -  see journalctl -u topogeo-web\n"
      "1 service, 2 units of this host not running, none failed, lost, silent or deaf, 0 faults\n");
  EXPECT_EQ(nlohmann::json::parse(table.json(kNow))[1]["state"], "failed");
  table.show_units({});
  EXPECT_TRUE(table.healthy(kNow));
}

TEST(StatusTable, MissingServicesHaveAllColumns) {
  StatusTable table;
  table.expect({"map_store"});
  EXPECT_THAT(table.text(kNow), HasSubstr("0 services, 1 missing, "));
  for (std::uint8_t number = 1; number <= 3; ++number) {
    const std::string place = number == 1 ? "1" : "2";
    msg::ServiceStatus status = status_of("planner", msg::kServiceRunning);
    messaging::set_service(status, "planner", "instance-" + std::to_string(number));
    messaging::set_robot_id(status, "r" + place);
    messaging::set_text(status.host(), "pc" + place, "host");
    table.update(status, info_of(number), kNow);
  }
  EXPECT_THAT(table.text(kNow),
              HasSubstr("SERVICE     PID  ROBOT  HOST  STATE    INPUT/s  AGE  FAULTS  REASON\n"));
  EXPECT_THAT(table.text(kNow),
              HasSubstr("map_store     -  -      -     missing        -    -       -\n"));
}

TEST(StatusTable, ServiceThatEndsInOrderIsNoLoss) {
  StatusTable table;
  table.update(status_of("ga_worker", msg::kServiceRunning), info_of(1), kNow);
  table.update(status_of("ga_worker", msg::kServiceStopped), info_of(1), kNow);
  table.remove(info_of(1));
  EXPECT_TRUE(table.empty());
  table.update(status_of("sensor_gateway", msg::kServiceFinished), info_of(2), kNow);
  table.remove(info_of(2));
  EXPECT_TRUE(table.empty());
  EXPECT_TRUE(table.healthy(kNow));
}

TEST(StatusTable, DetailsNameInputFaultsAndCounters) {
  StatusTable table;
  msg::ServiceStatus status =
      fed(status_of("localizer", msg::kServiceRunning), "local_map", 2.5, 0.2);
  msg::Counter counter;
  messaging::set_text(counter.name(), "tasks", "name");
  counter.value(1234567.0);
  status.counters().push_back(counter);
  msg::FaultCount fault;
  messaging::set_text(fault.reason(), "invalid local map", "reason");
  fault.count(2);
  status.faults().push_back(fault);
  table.update(status, info_of(1), kNow);
  table.update(status_of("planner", msg::kServiceRunning), info_of(2), kNow);
  const std::string text = table.details(kNow);
  EXPECT_THAT(text, HasSubstr("localizer  running, robot robot\n"));
  EXPECT_THAT(text, HasSubstr("100 local_map, 2.5/s, the last 0.2 s ago"));
  EXPECT_THAT(text, HasSubstr("2 invalid local map"));
  EXPECT_THAT(text, HasSubstr("1234567\n"));
  EXPECT_THAT(text, HasSubstr("4321 on pc, version 1.2, instance localizer-1"));
  table.keep_only("planner");
  EXPECT_THAT(table.details(kNow), Not(HasSubstr("localizer")));
}

/// A status with every possible report.
msg::ServiceStatus eventful() {
  msg::ServiceStatus status = status_of("planner", msg::kServiceRunning);
  messaging::set_text(status.waits_for(), "a map", "waits_for");
  messaging::set_text(status.last_error(), "send blocked: scan 7", "last_error");
  status.last_error_age_s(3.0);
  status.config_fingerprint(0xBEEF);
  msg::FaultCount drop;
  messaging::set_text(drop.reason(), "other robot", "reason");
  drop.count(12);
  status.drops().push_back(drop);
  msg::QueueDepth queue;
  messaging::set_text(queue.name(), "goals", "name");
  queue.depth(2);
  queue.capacity(64);
  status.queues().push_back(queue);
  msg::TopicTraffic traffic;
  messaging::set_text(traffic.topic(), "pose", "topic");
  traffic.messages(900);
  traffic.rate_per_s(24.6);
  traffic.waiting(5);
  status.traffic().push_back(traffic);
  return status;
}

TEST(StatusTable, AStrangersTextCommandsNoTerminal) {
  StatusTable table;
  msg::ServiceStatus status =
      status_of("plan\x1B[2Jner", msg::kServiceFailed, "a\nforged  running");
  messaging::set_text(status.version(), "\x1B]0;title\x07", "version");
  messaging::set_text(status.last_error(),
                      "\xC2\x9B"
                      "31m",
                      "error");
  table.update(status, info_of(1), kNow);
  for (const std::string& text : {table.text(kNow), table.details(kNow)}) {
    EXPECT_THAT(text, HasSubstr("plan?[2Jner"));
    EXPECT_THAT(text, HasSubstr("a?forged"));
    for (const char* const command : {"\x1B", "\x07", "\xC2\x9B", "\nforged"}) {
      EXPECT_THAT(text, Not(HasSubstr(command)));
    }
  }
}

TEST(StatusTable, SaysWhatIsMissingAndTheLastErrorWhileItIsFresh) {
  StatusTable table;
  table.update(eventful(), info_of(1), kNow);
  EXPECT_THAT(table.text(kNow), HasSubstr("needs a map; 3.0 s ago: send blocked: scan 7"));
  EXPECT_TRUE(table.healthy(kNow));
  msg::ServiceStatus later = eventful();
  later.last_error_age_s(3000.0);
  table.update(later, info_of(1), kNow);
  EXPECT_THAT(table.text(kNow), Not(HasSubstr("send blocked")));
  EXPECT_THAT(table.details(kNow), HasSubstr("last error 50 min ago: send blocked: scan 7"));
}

TEST(StatusTable, DetailsAndJsonHaveTrafficQueuesAndDrops) {
  StatusTable table;
  table.update(eventful(), info_of(1), kNow);
  const std::string text = table.details(kNow);
  EXPECT_THAT(text, HasSubstr("waits for  a map"));
  EXPECT_THAT(text, HasSubstr("config     000000000000beef"));
  EXPECT_THAT(text, HasSubstr("dropped    12 other robot"));
  EXPECT_THAT(text, HasSubstr("2 of 64"));
  EXPECT_THAT(text, HasSubstr("900, 25/s, 5 waiting"));
  const auto json = nlohmann::json::parse(table.json(kNow)).at(0);
  EXPECT_EQ(json["waits_for"], "a map");
  EXPECT_EQ(json["last_error"], "send blocked: scan 7");
  EXPECT_EQ(json["last_error_age_s"], 3.0);
  EXPECT_EQ(json["config_fingerprint"], "000000000000beef");
  EXPECT_EQ(json["drops"]["other robot"], 12);
  EXPECT_EQ(json["queues"][0]["depth"], 2);
  EXPECT_EQ(json["traffic"][0]["topic"], "pose");
  EXPECT_EQ(json["traffic"][0]["waiting"], 5);
}

TEST(StatusTable, JsonHasTheFieldsOfTheMessage) {
  StatusTable table;
  table.update(fed(status_of("localizer", msg::kServiceRunning), "local_map", 2.5, 0.2), info_of(1),
               kNow);
  table.update(status_of("planner", msg::kServiceStarting), info_of(2), kNow);
  const auto json = nlohmann::json::parse(table.json(kNow + seconds(1)));
  ASSERT_EQ(json.size(), 2U);
  EXPECT_EQ(json[0]["service"], "localizer");
  EXPECT_EQ(json[0]["state"], "running");
  EXPECT_EQ(json[0]["input"], "local_map");
  EXPECT_NEAR(json[0]["input_age_s"].get<double>(), 1.2, 1e-9);
  EXPECT_EQ(json[1]["state"], "starting");
  EXPECT_TRUE(json[1]["input_age_s"].is_null());
  EXPECT_EQ(StatusTable().json(kNow), "[]\n");
}

// deafness_test.cpp of messaging tests the verdict itself.
TEST(StatusTable, OneThatIsDeafIsUnwell) {
  const auto with_traffic = [](msg::ServiceStatus status, bool sent, double rate_per_s) {
    msg::TopicTraffic traffic;
    messaging::set_text(traffic.topic(), "pose", "topic");
    traffic.sent(sent);
    traffic.rate_per_s(rate_per_s);
    status.traffic().push_back(traffic);
    status.uptime_s(60.0);
    return status;
  };
  StatusTable table;
  table.update(with_traffic(status_of("localizer", msg::kServiceRunning), true, 10.0), info_of(1),
               kNow);
  const auto navigator = with_traffic(status_of("navigator", msg::kServiceRunning), false, 0.0);
  table.update(fed(navigator, "pose", 0.0, 5.7), info_of(2), kNow);
  EXPECT_FALSE(table.healthy(kNow));
  EXPECT_THAT(table.text(kNow), HasSubstr("deaf: none of the 10.0 pose/s of localizer arrives"));
  EXPECT_THAT(table.text(kNow), HasSubstr("1 failed, lost, silent or deaf"));
  EXPECT_THAT(table.json(kNow), HasSubstr("\"deaf\""));
  table.update(fed(navigator, "pose", 0.0, 0.1), info_of(2), kNow);
  EXPECT_TRUE(table.healthy(kNow));
}

}  // namespace
}  // namespace topogeo::cli
