// An exploration ordered from the page, with a robot played by the test.
#include <cstdint>
#include <thread>

#include <gmock/gmock.h>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/planning.h"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"

#include "program.hpp"
#include "web_client.hpp"
#include "web_programs.hpp"

namespace topogeo::test {
namespace {

constexpr const char* kRobot = "robot";

messaging::ParticipantOptions options_of_test() {
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
  options.name = "test";
  return options;
}

/// It is localized, accepts each goal, and reaches none. Lives in a thread of its own.
class RobotThatGetsNowhere {
 public:
  RobotThatGetsNowhere() : participant_(options_of_test()) {
    loop_.add<msg::Goal>(goals_, [this](const msg::Goal& goal, const messaging::SampleInfo&) {
      navigator_.goal_id = goal.kind() == msg::kGoalCancel ? 0 : goal.goal_id();
      navigator_.state = navigator_.goal_id == 0 ? navigation::NavigatorState::kIdle
                                                 : navigation::NavigatorState::kStopped;
      navigator_.reason = navigator_.goal_id == 0 ? navigation::HaltReason::kNone
                                                  : navigation::HaltReason::kNoRoute;
    });
    loop_.add_timer(std::chrono::milliseconds(100), [this] { tell(); });
    thread_ = std::thread([this] { loop_.run(); });
  }
  RobotThatGetsNowhere(const RobotThatGetsNowhere&) = delete;
  RobotThatGetsNowhere& operator=(const RobotThatGetsNowhere&) = delete;
  ~RobotThatGetsNowhere() {
    loop_.stop();
    thread_.join();
  }

 private:
  void tell() {
    ++told_;
    const auto stamp_ns = static_cast<std::int64_t>(told_) * 100'000'000;
    service::LivePose pose;
    pose.stamp_ns = stamp_ns;
    pose.sequence = told_;
    pose.status.state = localization::LocalizationState::kTracking;
    pose.status.confidence = 1.0;
    static_cast<void>(poses_.write(service::to_msg(pose, kRobot)));
    navigator_.T_map_robot = geometry::Pose2{};
    static_cast<void>(statuses_.write(service::to_msg(navigator_, kRobot, stamp_ns, told_)));
  }

  messaging::Participant participant_;
  messaging::EventLoop loop_;
  messaging::Writer<msg::LivePose> poses_{participant_};
  messaging::Writer<msg::NavigatorStatus> statuses_{participant_};
  messaging::Reader<msg::Goal> goals_{participant_};
  navigation::NavigatorStatus navigator_;
  std::uint64_t told_ = 0;
  std::thread thread_;
};

/// Most of the room is unseen.
class WebOnBeginning : public WebOnMap {
 protected:
  WebOnBeginning() : WebOnMap(30) {}
};

// The last target is given up without being reached: the robot must not keep trying.
TEST_F(WebOnBeginning, AnExplorationThatEndsTakesItsGoalBack) {
  const RobotThatGetsNowhere robot;
  PageModel page;
  WebSocketClient socket(port_);
  socket.send({{"op", "hello"}, {"token", kToken}});
  ASSERT_TRUE(page.wait_for(
      socket,
      [&] {
        return is_whole(page) && page.has("pose") && page.has("navigator") && page.has("goals");
      },
      kPagePatience));
  ASSERT_EQ(http_post(port_, "/api/explore", kToken).status, 202);
  bool had_a_goal = false;
  ASSERT_TRUE(page.wait_for(
      socket,
      [&] {
        const nlohmann::json& goals = page.values["goals"];
        had_a_goal = had_a_goal || !goals["current"].is_null();
        return had_a_goal && goals["exploring"] == false;
      },
      kPagePatience))
      << page.values["goals"];
  EXPECT_TRUE(page.wait_for(
      socket,
      [&] {
        return page.values["goals"]["current"].is_null() &&
               page.values["navigator"]["state"] == "idle";
      },
      kPagePatience))
      << page.values["goals"] << page.values["navigator"];
}

}  // namespace
}  // namespace topogeo::test
