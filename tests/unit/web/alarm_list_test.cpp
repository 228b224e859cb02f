#include "channels/alarm_list.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "channels/event_log.hpp"
#include "server/json_values.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kSecond_ns = 1'000'000'000;

/// The alarms that a page shows, by number.
Json shown(const ChannelHub& hub, Channel channel = Channel::kAlarms) {
  return Json::parse(*hub.update(channel, 0).text)["set"];
}

class AlarmListTest : public testing::Test {
 protected:
  ChannelHub hub_;
  AlarmList alarms_{hub_};
};

TEST_F(AlarmListTest, AnAlarmStaysUntilItIsAcknowledgedAndThenNamesWhoDid) {
  alarms_.raise(10 * kSecond_ns, "error", "base", "emergency stop");
  EXPECT_EQ(shown(hub_)["1"], Json::parse(R"({"level":"error","source":"base",
      "text":"emergency stop","first_s":10.0,"time_s":10.0,"count":1,"acknowledged_by":""})"));
  const std::vector<std::uint64_t> first = {1};
  EXPECT_THAT(alarms_.acknowledge(20 * kSecond_ns, first, "Anna"),
              ElementsAre("base: emergency stop"));
  EXPECT_EQ(shown(hub_)["1"]["acknowledged_by"], "Anna");
  EXPECT_EQ(shown(hub_)["1"]["acknowledged_s"], 20.0);
  EXPECT_THAT(alarms_.acknowledge(30 * kSecond_ns, first, "Ben"), IsEmpty());
  EXPECT_EQ(shown(hub_)["1"]["acknowledged_by"], "Anna") << "the first one";
  const std::vector<std::uint64_t> unknown = {7, 0};
  EXPECT_THAT(alarms_.acknowledge(0, unknown, "Ben"), IsEmpty());
}

TEST_F(AlarmListTest, TheSameTroubleCountsUntilItIsAcknowledged) {
  for (int i = 1; i <= 3; ++i) alarms_.raise(i * kSecond_ns, "error", "laser", "offline");
  alarms_.raise(4 * kSecond_ns, "error", "base", "offline");
  EXPECT_EQ(shown(hub_).size(), 2U);
  EXPECT_EQ(shown(hub_)["1"]["count"], 3);
  EXPECT_EQ(shown(hub_)["1"]["first_s"], 1.0);
  EXPECT_EQ(shown(hub_)["1"]["time_s"], 3.0);
  const std::vector<std::uint64_t> first = {1};
  EXPECT_EQ(alarms_.acknowledge(5 * kSecond_ns, first, "Anna").size(), 1U);
  alarms_.raise(6 * kSecond_ns, "error", "laser", "offline");
  EXPECT_EQ(shown(hub_)["3"]["acknowledged_by"], "") << "another alarm";
}

TEST_F(AlarmListTest, ForgetsAcknowledgedAlarmsFirst) {
  const auto raise = [&](std::size_t number) {
    alarms_.raise(0, "warning", "base", std::to_string(number));
  };
  for (std::size_t i = 1; i <= AlarmList::kKept; ++i) raise(i);
  const std::vector<std::uint64_t> second = {2};
  EXPECT_EQ(alarms_.acknowledge(0, second, "Anna").size(), 1U);
  raise(AlarmList::kKept + 1);
  EXPECT_FALSE(shown(hub_).contains("2"));
  EXPECT_TRUE(shown(hub_).contains("1"));
  raise(AlarmList::kKept + 2);
  EXPECT_FALSE(shown(hub_).contains("1")) << "the oldest";
  EXPECT_EQ(shown(hub_).size(), AlarmList::kKept);
}

TEST(EventLogAlarms, AnAlarmAndItsAcknowledgmentAreEvents) {
  ChannelHub hub;
  EventLog events(hub);
  events.alarm(EventLog::Level::kError, "localizer", "is gone");
  const std::vector<std::uint64_t> all = {1, 2};
  events.acknowledge(all, "Anna");
  const Json shown_events = shown(hub, Channel::kEvents);
  ASSERT_EQ(shown_events.size(), 2U);
  EXPECT_EQ(shown_events["1"]["level"], "error");
  EXPECT_EQ(shown_events["1"]["text"], "is gone");
  EXPECT_EQ(shown_events["2"]["source"], "operator");
  EXPECT_EQ(shown_events["2"]["text"], "Anna: acknowledges the alarm localizer: is gone");
}

}  // namespace
}  // namespace topogeo::web
