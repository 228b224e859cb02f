// A frozen planner, and statuses received beside it. The tests advance the time.
#include "topogeo/live/unheard_services.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/live/status_table.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"

namespace topogeo::cli {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

messaging::RemoteEndpoint status_writer(std::uint8_t number, const std::string& participant) {
  messaging::RemoteEndpoint endpoint;
  endpoint.id.bytes[0] = number;
  endpoint.participant = participant;
  endpoint.topic = std::string(messaging::kServiceStatus);
  endpoint.writer = true;
  endpoint.partitions = {"topogeo"};
  return endpoint;
}

class UnheardServicesTest : public testing::Test {
 protected:
  void hear(std::uint8_t writer, const std::string& service, std::uint32_t pid) {
    msg::ServiceStatus status;
    messaging::set_service(status, service, service + "-" + std::to_string(writer));
    messaging::set_text(status.host(), "robot", "host");
    status.process_id(pid);
    messaging::SampleInfo info;
    info.writer.bytes[0] = writer;
    unheard_.heard(status, info, now_);
  }
  static HostProcess process(pid_t pid, const std::string& service) {
    return {pid, pid, service, 3, "topogeo", false, 60.0};
  }

  UnheardServices::Time now_{};
  UnheardServices unheard_{3, "*"};
};

TEST_F(UnheardServicesTest, AreThoseThatDiscoveryFindsAndNoStatusComesOf) {
  const std::vector<messaging::RemoteEndpoint> endpoints = {status_writer(1, "r1/planner"),
                                                            status_writer(2, "r1/localizer")};
  unheard_.discovered(endpoints, now_);
  hear(2, "localizer", 20);
  EXPECT_TRUE(unheard_.may_come(now_ + milliseconds(1000)));
  EXPECT_THAT(unheard_.list(now_ + milliseconds(1000)), IsEmpty()) << "it may still come";
  now_ += milliseconds(1600);
  unheard_.discovered(endpoints, now_);
  EXPECT_FALSE(unheard_.may_come(now_));
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_EQ(unheard_.list(now_)[0].name, "planner");
  EXPECT_THAT(unheard_.list(now_)[0].reason, HasSubstr("'r1/planner'"));
  hear(1, "planner", 10);
  EXPECT_THAT(unheard_.list(now_), IsEmpty());
}

TEST_F(UnheardServicesTest, AreThoseThatRunOnThisHost) {
  HostProcess frozen = process(10, "planner");
  frozen.stopped = true;
  unheard_.running({frozen, process(20, "localizer")}, "robot");
  hear(2, "localizer", 20);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_EQ(unheard_.list(now_)[0].name, "planner");
  EXPECT_THAT(unheard_.list(now_)[0].reason, HasSubstr("process 10 of this host is stopped"));
}

// Containers on the network of the host: each counts its processes for itself.
TEST_F(UnheardServicesTest, AreNotThoseInContainersThatAreHeard) {
  HostProcess planner = process(1010, "planner");
  HostProcess localizer = process(1020, "localizer");
  planner.own_pid = 7;
  localizer.own_pid = 7;
  unheard_.running({planner, localizer}, "robot");
  hear(1, "planner", 7);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_THAT(unheard_.list(now_)[0].reason, HasSubstr("process 1020 of this host runs"));
  hear(2, "localizer", 7);
  EXPECT_THAT(unheard_.list(now_), IsEmpty());
}

// Each worker is process 7 of its container.
TEST_F(UnheardServicesTest, AreThoseBesideAHeardOneWithTheSameNumber) {
  HostProcess frozen = process(1010, "ga_worker");
  HostProcess heard = process(1020, "ga_worker");
  frozen.own_pid = 7;
  heard.own_pid = 7;
  frozen.stopped = true;
  unheard_.running({frozen, heard}, "robot");
  hear(1, "ga_worker", 7);
  hear(1, "ga_worker", 7);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_THAT(unheard_.list(now_)[0].reason, HasSubstr("process 1010 of this host is stopped"));
  hear(2, "ga_worker", 7);
  EXPECT_THAT(unheard_.list(now_), IsEmpty());
}

// The heard one of two that run is unknown.
TEST_F(UnheardServicesTest, AreNamedWithTheHeardOneOfTheirNumber) {
  HostProcess one = process(1010, "ga_worker");
  HostProcess other = process(1020, "ga_worker");
  HostProcess young = process(1000, "ga_worker");
  one.own_pid = 7;
  other.own_pid = 7;
  young.own_pid = 7;
  young.age_s = 2.0;
  unheard_.running({young, one, other}, "robot");
  hear(1, "ga_worker", 7);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_EQ(unheard_.list(now_)[0].reason,
            "one of the processes 1010, 1020 of this host publishes no status");
  hear(2, "ga_worker", 7);
  EXPECT_THAT(unheard_.list(now_), IsEmpty()) << "the young one may still come";
}

TEST_F(UnheardServicesTest, AreInOneRowIfAnyOfThemMayBeTheHeardOne) {
  std::vector<HostProcess> workers = {process(1010, "ga_worker"), process(1020, "ga_worker"),
                                      process(1030, "ga_worker")};
  for (HostProcess& worker : workers) worker.own_pid = 7;
  unheard_.running(workers, "robot");
  hear(1, "ga_worker", 7);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_EQ(unheard_.list(now_)[0].reason,
            "2 of the processes 1010, 1020, 1030 of this host publish no status");
}

// A worker that was started again in its container has its number and another instance.
TEST_F(UnheardServicesTest, AreNotHiddenByAServiceThatWasHeardLongAgo) {
  HostProcess frozen = process(1010, "ga_worker");
  HostProcess heard = process(1020, "ga_worker");
  frozen.own_pid = 7;
  heard.own_pid = 7;
  frozen.stopped = true;
  hear(1, "ga_worker", 7);
  hear(2, "ga_worker", 7);
  unheard_.running({frozen, heard}, "robot");
  EXPECT_THAT(unheard_.list(now_ + UnheardServices::kRemembered), IsEmpty());
  now_ += UnheardServices::kRemembered + milliseconds(1);
  hear(2, "ga_worker", 7);
  ASSERT_THAT(unheard_.list(now_), SizeIs(1));
  EXPECT_THAT(unheard_.list(now_)[0].reason, HasSubstr("process 1010 of this host is stopped"));
}

TEST_F(UnheardServicesTest, AreNamedOnce) {
  const std::vector<messaging::RemoteEndpoint> endpoints = {status_writer(1, "r1/planner")};
  unheard_.discovered(endpoints, now_);
  unheard_.running({process(10, "planner")}, "robot");
  EXPECT_THAT(unheard_.list(now_ + milliseconds(1600)), SizeIs(1));
}

TEST_F(UnheardServicesTest, AreOfTheDomainAndPartitionThatIsShown) {
  HostProcess other = process(10, "planner");
  other.domain = 4;
  HostProcess young = process(11, "planner");
  young.age_s = 2.0;
  unheard_.running({other, young}, "robot");
  EXPECT_THAT(unheard_.list(now_), IsEmpty());
  UnheardServices of_partition(3, "run-1");
  of_partition.running({process(12, "planner")}, "robot");
  const std::vector<messaging::RemoteEndpoint> endpoints = {status_writer(1, "r1/planner")};
  of_partition.discovered(endpoints, now_);
  EXPECT_THAT(of_partition.list(now_ + milliseconds(9000)), IsEmpty());
}

TEST_F(UnheardServicesTest, AreInTheTable) {
  StatusTable table;
  table.expect({"planner"});
  table.show_unheard(
      {{"planner", "process 10 of this host is stopped, and no status of it comes"}});
  EXPECT_FALSE(table.healthy(now_));
  EXPECT_THAT(table.missing(), IsEmpty());
  EXPECT_THAT(table.text(now_), HasSubstr("silent"));
  EXPECT_THAT(table.text(now_), HasSubstr("1 service, 1 failed, lost, silent or deaf"));
  EXPECT_THAT(table.json(now_), HasSubstr("process 10 of this host is stopped"));
}

}  // namespace
}  // namespace topogeo::cli
