// Which reports of a base and a laser are alarms.
#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "topogeo/msg/sensor.h"

#include "channels/event_log.hpp"
#include "channels/robot_view.hpp"
#include "messaging/fixture.hpp"
#include "server/json_values.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

service::Setup alarms_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

class RobotAlarms : public testing::Test {
 protected:
  RobotAlarms() {
    EXPECT_TRUE(messaging::wait_for_peers(bases_) && messaging::wait_for_peers(lasers_));
  }
  /// The view has taken it.
  void report(msg::BaseState state, bool battery_low = false) {
    auto status = messaging::message<msg::BaseStatus>();
    status.state(state);
    status.battery_low(battery_low);
    // A number of its own makes each report differ on the hub.
    status.battery_v(static_cast<float>(++reports_));
    EXPECT_TRUE(bases_.write(status));
    wait_for(Channel::kBase, "battery_v", reports_);
  }
  void report(msg::LaserState state) {
    auto status = messaging::message<msg::LaserStatus>();
    status.state(state);
    status.scans_per_s(static_cast<float>(++reports_));
    EXPECT_TRUE(lasers_.write(status));
    wait_for(Channel::kLaser, "scans_per_s", reports_);
  }
  /// "source: text" of each alarm.
  [[nodiscard]] std::vector<std::string> alarms() const {
    std::vector<std::string> out;
    if (hub_.version(Channel::kAlarms) == 0) return out;
    const Json message = Json::parse(*hub_.update(Channel::kAlarms, 0).text);
    for (const auto& [number, alarm] : message["set"].items()) {
      out.push_back(alarm["source"].get<std::string>() + ": " + alarm["text"].get<std::string>());
    }
    return out;
  }

 private:
  void wait_for(Channel channel, const char* key, int value) {
    ASSERT_TRUE(test::wait_in_loop(service_.loop(), "a report", [&] {
      return hub_.version(channel) > 0 &&
             Json::parse(*hub_.update(channel, 0).text)["value"][key] == value;
    }));
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{alarms_setup(partition_)};
  ChannelHub hub_;
  EventLog events_{hub_};
  RobotView robot_{service_, hub_, events_};
  messaging::Participant devices_{messaging::options_in(partition_)};
  messaging::Writer<msg::BaseStatus> bases_{devices_};
  messaging::Writer<msg::LaserStatus> lasers_{devices_};
  int reports_ = 0;
};

TEST_F(RobotAlarms, AStartAndAnOperatorsStopAreNone) {
  for (const msg::BaseState state : {msg::kBaseOffline, msg::kBaseStarting, msg::kBaseReady,
                                     msg::kBaseMoving, msg::kBaseHalted, msg::kBaseJoystick}) {
    report(state);
  }
  report(msg::kLaserOffline);
  report(msg::kLaserStarting);
  report(msg::kLaserRunning);
  EXPECT_THAT(alarms(), IsEmpty());
}

TEST_F(RobotAlarms, WhatAPersonMustSeeIsOneEachTime) {
  report(msg::kBaseReady);
  report(msg::kBaseEmergencyStop);
  report(msg::kBaseEmergencyStop);
  report(msg::kBaseReady, true);
  report(msg::kBaseReady, true);
  report(msg::kBaseOffline, true);
  report(msg::kLaserRunning);
  report(msg::kLaserOffline);
  EXPECT_THAT(alarms(), ElementsAre("base: emergency_stop", "base: the battery is low",
                                    "base: offline", "laser: offline"));
}

}  // namespace
}  // namespace topogeo::web
