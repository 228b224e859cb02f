// Output of `topogeo top` for given statuses.
#include "topogeo/live/pool_table.hpp"

#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "topogeo/messaging/message.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kOwnFingerprint = 77;
const PoolTable::Clock::time_point kMoment{std::chrono::hours(1)};

messaging::SampleInfo number(std::uint8_t n) {
  messaging::SampleInfo info;
  info.valid = true;
  info.instance.bytes[0] = n;
  return info;
}

msg::WorkerStatus pool_worker(const std::string& name, const std::string& host, double load) {
  msg::WorkerStatus status;
  messaging::set_worker_id(status, name + "#1");
  messaging::set_text(status.name(), name, "name");
  messaging::set_text(status.host(), host, "host");
  messaging::set_text(status.version(), "1.2.3", "version");
  status.process_id(4'000'001);
  status.slots(4);
  status.load(load);
  status.tasks_in_hand(load > 0.0 ? 8 : 0);
  status.tasks_per_s(100.0 * load);
  status.matcher_fingerprint(kOwnFingerprint);
  return status;
}

msg::ServiceStatus worker_service(const std::string& worker_id, std::uint64_t faults) {
  msg::ServiceStatus status;
  messaging::set_service(status, "ga_worker", worker_id);
  status.state(msg::kServiceRunning);
  status.fault_count(faults);
  return status;
}

msg::ServiceStatus localizer_of(const std::string& robot, std::uint64_t open,
                                double tasks_sent = 0.0) {
  msg::ServiceStatus status;
  messaging::set_robot_id(status, robot);
  messaging::set_service(status, "localizer", robot + "-1");
  status.state(msg::kServiceRunning);
  msg::QueueDepth queue;
  messaging::set_text(queue.name(), "match tasks", "name");
  queue.depth(open);
  status.queues().push_back(queue);
  msg::Counter counter;
  for (const auto& [name, value] :
       {std::pair("workers", 2.0), std::pair("workers_lost", 1.0),
        std::pair("tasks_in_process", 33.0), std::pair("tasks_sent", tasks_sent)}) {
    messaging::set_text(counter.name(), name, "name");
    counter.value(value);
    status.counters().push_back(counter);
  }
  return status;
}

class PoolTableTest : public testing::Test {
 protected:
  PoolTable table_{"1.2.3", kOwnFingerprint};
};

msg::ServiceStatus short_of_cpu(msg::ServiceStatus status) {
  msg::Counter counter;
  messaging::set_text(counter.name(), "cpu_short", "name");
  counter.value(1.0);
  status.counters().push_back(counter);
  messaging::set_text(counter.name(), "timer_delay_s", "name");
  counter.value(0.3);
  status.counters().push_back(counter);
  return status;
}

TEST_F(PoolTableTest, NamesWhoIsShortOfCpu) {
  table_.update(pool_worker("a", "pc1", 0.75), number(1), kMoment);
  table_.update(pool_worker("b", "pc2", 0.0), number(2), kMoment);
  table_.update(short_of_cpu(worker_service("a#1", 0)), number(3), kMoment);
  table_.update(worker_service("b#1", 0), number(5), kMoment);
  table_.update(short_of_cpu(localizer_of("r1", 4)), number(4), kMoment);
  const std::string text = table_.text(kMoment, {200, 0});
  EXPECT_THAT(text, HasSubstr("working; the CPU is short: timers fire up to 0.3 s late\n"));
  EXPECT_THAT(text, HasSubstr("idle\n"));
  EXPECT_THAT(text, HasSubstr("running; the CPU is short: timers fire up to 0.3 s late\n"));
}

TEST_F(PoolTableTest, ShowsWorkersWithTheirFaultsAndRobotsWithTheirTasks) {
  table_.update(pool_worker("a", "pc1", 0.75), number(1), kMoment);
  table_.update(pool_worker("b", "pc2", 0.0), number(2), kMoment);
  table_.update(worker_service("a#1", 3), number(3), kMoment);
  table_.update(localizer_of("r1", 4, 100.0), number(4), kMoment - std::chrono::seconds(2));
  table_.update(localizer_of("r1", 17, 125.0), number(4), kMoment);
  EXPECT_EQ(table_.text(kMoment),
            "2 workers, 8 slots 38 % busy, 75.0 tasks/s, 8 in hand, 17 open\n"
            "\n"
            "WORKER  HOST  SLOTS  LOAD  TASKS/s  QUEUE  FAULTS  STATE\n"
            "a       pc1       4  75 %     75.0      8       3  working\n"
            "b       pc2       4   0 %      0.0      0       0  idle\n"
            "\n"
            "ROBOT  OPEN  SENT/s  WORKERS  LOST  RESENT  OWN  LOCALIZER\n"
            "r1       17    12.5        2     1       0   33  running\n");
}

TEST_F(PoolTableTest, FitsInEightyColumnsAndTheRowsOfTheWindow) {
  for (std::uint8_t i = 0; i < 40; ++i) {
    msg::WorkerStatus status = pool_worker("worker-of-the-institute",
                                           "computer-of-an-institute-" + std::to_string(i), 1.0);
    messaging::set_worker_id(status, "w#" + std::to_string(i));
    table_.update(status, number(i), kMoment);
  }
  table_.update(localizer_of(std::string(32, 'r'), 99'999), number(100), kMoment);
  const std::string text = table_.text(kMoment, {80, 24});
  std::istringstream lines(text);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line); ++count) EXPECT_LE(line.size(), 80U) << line;
  EXPECT_LE(count, 24U) << text;
  EXPECT_THAT(text, HasSubstr("more: the window has no room"));
  EXPECT_THAT(table_.text(kMoment), Not(HasSubstr("more:"))) << "no window, no limit";
}

TEST_F(PoolTableTest, WhoIsSilentCountsNoMoreAndIsForgotten) {
  table_.update(pool_worker("a", "pc1", 1.0), number(1), kMoment);
  table_.update(localizer_of("r1", 0), number(2), kMoment);
  EXPECT_THAT(table_.text(kMoment + seconds(3)),
              AllOf(HasSubstr("1 worker, 0 slots"), HasSubstr("silent for 3 s")));
  table_.forget_silent(kMoment + seconds(11));
  EXPECT_EQ(table_.workers(), 0U);
  EXPECT_THAT(table_.text(kMoment + seconds(11)),
              AllOf(HasSubstr("no search worker"), HasSubstr("no robot asks for work")));
}

TEST_F(PoolTableTest, WhoLeavesIsGone) {
  table_.update(pool_worker("a", "pc1", 1.0), number(1), kMoment);
  table_.update(worker_service("a#1", 3), number(2), kMoment);
  table_.update(localizer_of("r1", 5), number(3), kMoment);
  table_.remove_worker(number(1));
  table_.remove_service(number(2));
  table_.remove_service(number(3));
  table_.remove_service(number(9));
  EXPECT_THAT(table_.text(kMoment), AllOf(HasSubstr("0 workers"), HasSubstr("0 open")));
  table_.update(localizer_of("r1", 5), number(3), kMoment);
  msg::ServiceStatus stopped = localizer_of("r1", 5);
  stopped.state(msg::kServiceStopped);
  table_.update(stopped, number(3), kMoment);
  EXPECT_THAT(table_.text(kMoment), HasSubstr("no robot asks for work"));
}

TEST_F(PoolTableTest, JsonHasTheSameNumbers) {
  table_.update(pool_worker("a", "pc1", 0.5), number(1), kMoment);
  table_.update(worker_service("a#1", 3), number(2), kMoment);
  table_.update(localizer_of("r1", 17), number(3), kMoment);
  const auto json = nlohmann::json::parse(table_.json(kMoment, -1));
  EXPECT_EQ(json["workers"][0]["name"], "a");
  EXPECT_EQ(json["workers"][0]["load"], 0.5);
  EXPECT_EQ(json["workers"][0]["fault_count"], 3);
  EXPECT_EQ(json["workers"][0]["state"], "working");
  EXPECT_EQ(json["robots"][0]["open_tasks"], 17);
  EXPECT_EQ(json["robots"][0]["tasks_in_process"], 33.0);
  EXPECT_EQ(json["total"]["busy_slots"], 2.0);
  EXPECT_EQ(json["total"]["open_tasks"], 17);
}

}  // namespace
}  // namespace topogeo::cli
