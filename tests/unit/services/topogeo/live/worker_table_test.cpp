// Output of `topogeo workers` for given statuses.
#include "topogeo/live/worker_table.hpp"

#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "topogeo/messaging/message.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint64_t kFingerprint = 77;

msg::WorkerStatus worker(const std::string& id, const std::string& name) {
  msg::WorkerStatus status;
  messaging::set_worker_id(status, id);
  messaging::set_text(status.name(), name, "name");
  messaging::set_text(status.host(), "pc1", "host");
  messaging::set_text(status.version(), "1.2.3", "version");
  status.process_id(4321);
  status.slots(4);
  status.load(0.75);
  status.tasks_in_hand(8);
  status.tasks_done(1000);
  status.tasks_per_s(250.5);
  status.failures(3);
  status.clients(2);
  status.maps_held(640);
  status.uptime_s(3725.0);
  status.matcher_fingerprint(kFingerprint);
  return status;
}

messaging::SampleInfo instance(std::uint8_t number) {
  messaging::SampleInfo info;
  info.instance.bytes[0] = number;
  return info;
}

class WorkerTableTest : public testing::Test {
 protected:
  WorkerTable table_{"1.2.3", kFingerprint};
  WorkerTable::Clock::time_point start_ = WorkerTable::Clock::now();
};

TEST_F(WorkerTableTest, ShowsEveryWorkerAndTheSums) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  msg::WorkerStatus idle = worker("b#2", "b");
  idle.slots(1);
  idle.load(0.0);
  idle.tasks_in_hand(0);
  idle.tasks_per_s(0.0);
  table_.update(idle, instance(2), start_);
  const std::string text = table_.text(start_);
  EXPECT_THAT(text, AllOf(HasSubstr("75 %"), HasSubstr("250.5"), HasSubstr("working"),
                          HasSubstr("idle"), Not(HasSubstr("4321"))));
  EXPECT_THAT(text, HasSubstr("2 workers, 5 slots, 60 % busy, 2000 tasks done, 250.5 tasks/s"));
}

TEST_F(WorkerTableTest, TwoWorkersOfOneNameAreTwoRows) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  table_.update(worker("a#2", "a"), instance(2), start_);
  table_.update(worker("a#2", "a"), instance(2), start_);
  EXPECT_THAT(table_.text(start_), AllOf(HasSubstr("2 workers"), HasSubstr("4321")));
}

TEST_F(WorkerTableTest, FitsIntoATerminalWhateverItsNames) {
  msg::WorkerStatus busy = worker("a#1", "worker-of-the-institute1");
  messaging::set_text(busy.host(), "computer-of-an-institute", "host");
  busy.tasks_done(123'456'789);
  busy.tasks_per_s(12'345.6);
  table_.update(busy, instance(1), start_);
  msg::WorkerStatus other = busy;
  messaging::set_text(other.host(), "pc1", "host");
  messaging::set_text(other.version(), "0.9", "version");
  table_.update(other, instance(2), start_);
  messaging::set_worker_id(other, "a#2");
  table_.update(other, instance(3), start_);
  std::istringstream lines(table_.text(start_));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), kColumns) << line;
}

TEST_F(WorkerTableTest, DetailsHaveWhatTheTableLeavesOut) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  EXPECT_THAT(table_.details(start_),
              AllOf(HasSubstr("4321 on pc1, version 1.2.3"), HasSubstr("1:02:05"),
                    HasSubstr("8 tasks in hand"), HasSubstr("2 robots, 640 maps held")));
}

TEST_F(WorkerTableTest, ASilentWorkerIsMarkedNotCountedAndForgotten) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  EXPECT_THAT(table_.text(start_ + milliseconds(1400)), Not(HasSubstr("silent")));
  const std::string text = table_.text(start_ + seconds(3));
  EXPECT_THAT(text, AllOf(HasSubstr("silent for 3 s"), HasSubstr("0 slots")));
  table_.forget_silent(start_ + seconds(11));
  EXPECT_TRUE(table_.empty());
}

TEST_F(WorkerTableTest, AWorkerThatSaysGoodbyeIsGone) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  table_.remove(instance(2));
  EXPECT_FALSE(table_.empty());
  table_.remove(instance(1));
  EXPECT_TRUE(table_.empty());
}

TEST_F(WorkerTableTest, SaysWhyAWorkerIsNotUsed) {
  msg::WorkerStatus other = worker("a#1", "a");
  messaging::set_text(other.version(), "0.9", "version");
  table_.update(other, instance(1), start_);
  EXPECT_THAT(table_.text(start_), HasSubstr("other version: 0.9, this is 1.2.3"));
  other = worker("a#1", "a");
  other.matcher_fingerprint(1);
  table_.update(other, instance(1), start_);
  EXPECT_THAT(table_.text(start_), HasSubstr("computes differently"));
  other = worker("a#1", "a");
  other.draining(true);
  table_.update(other, instance(1), start_);
  EXPECT_THAT(table_.text(start_), HasSubstr("draining"));
}

TEST_F(WorkerTableTest, JsonHasTheFieldsOfTheStatus) {
  table_.update(worker("a#1", "a"), instance(1), start_);
  const auto json = nlohmann::json::parse(table_.json(start_));
  ASSERT_EQ(json.size(), 1U);
  EXPECT_EQ(json[0]["worker_id"], "a#1");
  EXPECT_EQ(json[0]["slots"], 4);
  EXPECT_EQ(json[0]["load"], 0.75);
  EXPECT_EQ(json[0]["state"], "working");
}

}  // namespace
}  // namespace topogeo::cli
