// A navigator and the localizer whose poses it is to follow.
#include "topogeo/deafness.hpp"

#include <array>
#include <string>

#include <gmock/gmock.h>

#include "topogeo/messaging/message.hpp"
#include "topogeo/status_table.hpp"

namespace topogeo::cli {
namespace {

using testing::HasSubstr;

msg::ServiceStatus service(const std::string& name, const std::string& topic, bool sent,
                           double rate_per_s) {
  msg::ServiceStatus status;
  messaging::set_header(status, "robot", 0, 0);
  messaging::set_service(status, name, name + "-1");
  status.state(msg::kServiceRunning);
  status.uptime_s(60.0);
  msg::TopicTraffic traffic;
  messaging::set_text(traffic.topic(), topic, "topic");
  traffic.sent(sent);
  traffic.messages(500);
  traffic.rate_per_s(rate_per_s);
  status.traffic().push_back(traffic);
  return status;
}

class Deafness : public testing::Test {
 protected:
  Deafness() {
    messaging::set_text(navigator_.input(), "pose", "input");
    navigator_.inputs(500);
    navigator_.input_age_s(5.2);
  }

  [[nodiscard]] std::string found() const {
    const std::array<const msg::ServiceStatus*, 3> all = {&navigator_, &localizer_, &planner_};
    return deafness(navigator_, all);
  }

  msg::ServiceStatus localizer_ = service("localizer", "pose", true, 10.0);
  msg::ServiceStatus navigator_ = service("navigator", "pose", false, 0.0);
  msg::ServiceStatus planner_ = service("planner", "pose", false, 10.0);
};

TEST_F(Deafness, IsSilenceWhileTheSenderSends) {
  EXPECT_EQ(found(), "deaf: none of the 10.0 pose/s of localizer arrives");
  navigator_.state(msg::kServiceWaiting);
  EXPECT_FALSE(found().empty()) << "it may wait for what does not arrive";
}

TEST_F(Deafness, IsNoSilenceOfTheSender) {
  localizer_.traffic()[0].rate_per_s(0.0);  // the robot stands, or the sender is frozen
  EXPECT_EQ(found(), "");
  localizer_.traffic()[0].rate_per_s(0.4);  // one may be on its way
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsNoShortSilence) {
  navigator_.input_age_s(4.9);
  EXPECT_EQ(found(), "");
  navigator_.input_age_s(5.2);
  navigator_.traffic()[0].rate_per_s(0.2);
  EXPECT_EQ(found(), "") << "something arrives";
  navigator_.traffic()[0].rate_per_s(0.0);
  navigator_.traffic()[0].waiting(3);
  EXPECT_EQ(found(), "") << "it is busy with what has arrived";
}

TEST_F(Deafness, IsNotOfOneThatHasJustBegun) {
  navigator_.uptime_s(3.0);
  EXPECT_EQ(found(), "");
  navigator_.uptime_s(60.0);
  localizer_.uptime_s(3.0);
  EXPECT_EQ(found(), "");
  localizer_.uptime_s(60.0);
  localizer_.state(msg::kServiceFinished);
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsNotDecidedWhereTheSenderIsNotKnown) {
  messaging::set_robot_id(localizer_, "another");
  EXPECT_EQ(found(), "");
  messaging::set_robot_id(localizer_, "robot");
  planner_ = service("localizer", "pose", true, 10.0);
  EXPECT_EQ(found(), "") << "two localizers, perhaps of two partitions";
  planner_ = service("navigator", "pose", false, 10.0);
  EXPECT_EQ(found(), "") << "two navigators";
}

TEST_F(Deafness, IsNotOfATopicWhoseMessagesAreForOthers) {
  localizer_ = service("localizer", "match_tasks", true, 10.0);
  navigator_ = service("ga_worker", "match_tasks", false, 0.0);
  messaging::set_text(navigator_.input(), "match_tasks", "input");
  navigator_.input_age_s(60.0);
  EXPECT_EQ(found(), "");
}

TEST_F(Deafness, IsInTheTable) {
  const StatusTable::Clock::time_point now{};
  StatusTable table;
  const auto update = [&](const msg::ServiceStatus& status, std::uint8_t number) {
    messaging::SampleInfo info;
    info.valid = true;
    info.instance.bytes[0] = number;
    table.update(status, info, now);
  };
  update(localizer_, 1);
  update(navigator_, 2);
  EXPECT_FALSE(table.healthy(now));
  EXPECT_THAT(table.text(now), HasSubstr("deaf: none of the 10.0 pose/s of localizer arrives"));
  EXPECT_THAT(table.text(now), HasSubstr("1 failed, lost, silent or deaf"));
  EXPECT_THAT(table.json(now), HasSubstr("\"deaf\""));
  navigator_.input_age_s(0.1);
  update(navigator_, 2);
  EXPECT_TRUE(table.healthy(now));
}

}  // namespace
}  // namespace topogeo::cli
