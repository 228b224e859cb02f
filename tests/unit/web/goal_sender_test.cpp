// Pauses of a list of goals and of an exploration, with a navigator played by the test.
#include "orders/goal_sender.hpp"

#include <chrono>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/msg/planning.h"
#include "topogeo/msg/trajectory.h"

#include "channels/event_log.hpp"
#include "messaging/fixture.hpp"
#include "orders/exploration_sender.hpp"
#include "server/json_values.hpp"
#include "waiting.hpp"

namespace topogeo::web {
namespace {

service::Setup goals_setup(const std::string& partition) {
  service::Setup setup;
  setup.name = "web";
  setup.options.partition = partition;
  return setup;
}

/// Goals and orders received, and statuses that the test sends.
class PlayedNavigator {
 public:
  explicit PlayedNavigator(const std::string& partition)
      : participant_(messaging::options_in(partition)),
        goals_(participant_, {.role = "request"}),
        statuses_(participant_) {}

  /// Returns the sequence number of the status.
  std::uint64_t report(std::uint64_t goal, msg::NavigatorState state,
                       msg::HaltReason reason = msg::kHaltNone) {
    auto status = messaging::message<msg::NavigatorStatus>(++sent_);
    status.goal_id(goal);
    status.state(state);
    status.reason(reason);
    EXPECT_TRUE(statuses_.write(status));
    return sent_;
  }
  bool has_goal(std::uint64_t goal) {
    take();
    return goals_taken_.contains(goal);
  }
  bool has_order(msg::GoalKind kind) {
    take();
    return orders_taken_.contains(kind);
  }
  /// The goals that the orders to pause have named.
  const std::vector<std::uint64_t>& paused_goals() {
    take();
    return paused_goals_;
  }

 private:
  void take() {
    goals_.take([&](const msg::Goal& goal, const messaging::SampleInfo& info) {
      if (!info.valid) return;
      orders_taken_.insert(goal.kind());
      if (goal.kind() == msg::kGoalPause) paused_goals_.push_back(goal.goal_id());
      if (goal.kind() == msg::kGoalPosition) goals_taken_.insert(goal.goal_id());
    });
  }

  messaging::Participant participant_;
  messaging::Reader<msg::Goal> goals_;
  messaging::Writer<msg::NavigatorStatus> statuses_;
  std::uint64_t sent_ = 0;
  std::set<std::uint64_t> goals_taken_;
  std::set<msg::GoalKind> orders_taken_;
  std::vector<std::uint64_t> paused_goals_;
};

class GoalSenderTest : public testing::Test {
 protected:
  GoalSenderTest() {
    service_.subscribe<msg::NavigatorStatus>(
        [this](const msg::NavigatorStatus& status, const messaging::SampleInfo& info) {
          exploration_.take(status, goals_.take(status, info));
          taken_ = status.sequence_number();
        });
    // Goals and orders to cancel have another writer than orders to pause and to resume.
    EXPECT_TRUE(run_until(
        "the navigator to get an order to cancel",
        [&] { return taken_ > 0 && navigator_.has_order(msg::kGoalCancel); },
        [&] {
          navigator_.report(0, msg::kNavigatorIdle);
          goals_.cancel();
        }));
    EXPECT_TRUE(run_until(
        "the navigator to get an order to resume",
        [&] { return navigator_.has_order(msg::kGoalResume); }, [&] { goals_.resume(); }));
  }
  [[nodiscard]] bool run_until(
      const std::string& what, const std::function<bool()>& condition,
      const std::function<void()>& between = [] {}) {
    return test::wait_for(what, condition, [&] {
      between();
      service_.loop().run_for(std::chrono::milliseconds(5));
    });
  }
  /// The status has been taken.
  [[nodiscard]] bool report(std::uint64_t goal, msg::NavigatorState state,
                            msg::HaltReason reason = msg::kHaltNone) {
    const std::uint64_t sent = navigator_.report(goal, state, reason);
    return run_until("a status", [&] { return taken_ == sent; });
  }
  /// Two points in a row; the robot drives to the first, whose id is returned.
  std::uint64_t drive_to_first_of_two(double wait_s = 0.0, std::uint32_t rounds = 1) {
    WantedGoal first;
    first.point_m = Eigen::Vector2d(1.0, 0.0);
    first.wait_s = wait_s;
    WantedGoal second;
    second.point_m = Eigen::Vector2d(2.0, 0.0);
    const std::uint64_t id = goals_.add({{first, second}, false, rounds});
    EXPECT_TRUE(run_until("the first goal", [&] { return navigator_.has_goal(id); }));
    EXPECT_TRUE(report(id, msg::kNavigatorDriving));
    return id;
  }

  [[nodiscard]] Json shown_goals() const {
    return Json::parse(*hub_.update(Channel::kGoals, 0).text)["value"];
  }

  std::string partition_ = messaging::random_partition();
  service::Service service_{goals_setup(partition_)};
  ChannelHub hub_;
  EventLog events_{hub_};
  MapView map_{service_, hub_};
  GoalSender goals_{service_, hub_, map_, events_};
  RobotView robot_{service_, hub_, events_};
  int floors_ = 0;  // asked for by the exploration
  ExplorationSender exploration_{service_, goals_, events_, robot_, [this] {
                                   ++floors_;
                                   return ExploredFloor{};
                                 }};
  std::uint64_t taken_ = 0;  // sequence number of the last status taken
  PlayedNavigator navigator_{partition_};
};

// The status of the arrival was sent before the navigator got the pause.
TEST_F(GoalSenderTest, APauseHoldsTheNextGoalOfAListBack) {
  const std::uint64_t first = drive_to_first_of_two();
  goals_.pause();
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 1U) << "the second goal would undo the pause";
  EXPECT_TRUE(goals_.is_pausing());
  ASSERT_TRUE(report(first, msg::kNavigatorArrived, msg::kHaltPaused));
  EXPECT_FALSE(goals_.is_pausing());
  EXPECT_EQ(goals_.waiting(), 1U);
  goals_.resume();
  ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 0U) << "it is sent";
}

TEST_F(GoalSenderTest, APauseThatIsLostAtTheGoalIsRepeated) {
  const std::uint64_t first = drive_to_first_of_two();
  goals_.pause();
  ASSERT_TRUE(run_until("the pause", [&] { return !navigator_.paused_goals().empty(); }));
  EXPECT_TRUE(run_until(
      "the pause again", [&] { return navigator_.paused_goals().size() > 1; },
      [&] { navigator_.report(first, msg::kNavigatorArrived); }));
  EXPECT_EQ(navigator_.paused_goals().front(), 0U) << "it stops the robot whatever its goal is";
  EXPECT_EQ(navigator_.paused_goals().back(), first) << "a repeated one would stop a later goal";
}

TEST_F(GoalSenderTest, AnOperatorsGoalOrAResumeEndsAPause) {
  const std::uint64_t first = drive_to_first_of_two();
  goals_.pause();
  goals_.resume();
  EXPECT_FALSE(goals_.is_pausing());
  ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 0U);
  goals_.pause();
  EXPECT_TRUE(goals_.is_pausing());
  static_cast<void>(drive_to_first_of_two());
  EXPECT_FALSE(goals_.is_pausing());
}

TEST_F(GoalSenderTest, TheRobotStaysAtAGoalForItsTimeOrUntilAResume) {
  const std::uint64_t first = drive_to_first_of_two(3600.0);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 1U);
  const Json waits = shown_goals();
  EXPECT_EQ(waits["current"]["wait_s"], 3600.0);
  EXPECT_GT(waits["waits_s"].get<double>(), 0.0);
  goals_.resume();
  ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 0U) << "the second goal is sent";
  EXPECT_TRUE(shown_goals()["waits_s"].is_null());
}

TEST_F(GoalSenderTest, AListIsRepeatedWithOtherIdsAsOftenAsOrdered) {
  const std::uint64_t first = drive_to_first_of_two(0.0, 2);
  EXPECT_EQ(goals_.waiting(), 1U);
  std::set<std::string> ids = {std::to_string(first)};
  std::uint64_t current = first;
  for (const int round : {1, 2, 2}) {
    ASSERT_TRUE(report(current, msg::kNavigatorArrived));
    const Json goals = shown_goals();
    EXPECT_EQ(goals["round"]["now"], round);
    EXPECT_EQ(goals["round"]["of"], 2);
    const std::string id = goals["current"]["goal_id"];
    EXPECT_TRUE(ids.insert(id).second) << id;
    current = std::stoull(id);
    ASSERT_TRUE(run_until("the next goal", [&] { return navigator_.has_goal(current); }));
    ASSERT_TRUE(report(current, msg::kNavigatorDriving));
  }
  EXPECT_EQ(goals_.waiting(), 0U);
  ASSERT_TRUE(report(current, msg::kNavigatorArrived));
  EXPECT_FALSE(goals_.under_way());
}

TEST_F(GoalSenderTest, EndlessRoundsGoOnAfterAStopAndEndByACancel) {
  const std::uint64_t first = drive_to_first_of_two(0.0, 0);
  ASSERT_TRUE(report(first, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 2U) << "the next round";
  goals_.interrupt();
  EXPECT_FALSE(goals_.under_way());
  goals_.resume_interrupted();
  EXPECT_EQ(goals_.waiting(), 2U);
  goals_.cancel();
  const std::uint64_t again = drive_to_first_of_two();
  ASSERT_TRUE(report(again, msg::kNavigatorArrived));
  EXPECT_EQ(goals_.waiting(), 0U);
  EXPECT_TRUE(shown_goals()["round"].is_null());
}

TEST_F(GoalSenderTest, WhatAStopInterruptsIsKeptUntilAnotherOrder) {
  const std::uint64_t first = drive_to_first_of_two();
  goals_.interrupt();
  EXPECT_FALSE(goals_.under_way()) << "a released robot has no goal";
  ASSERT_TRUE(goals_.has_interrupted());
  EXPECT_FALSE(goals_.was_exploring());
  goals_.interrupt();
  EXPECT_TRUE(goals_.has_interrupted()) << "a second stop";
  ASSERT_TRUE(report(first, msg::kNavigatorStopped, msg::kHaltCancelled));
  goals_.resume_interrupted();
  EXPECT_FALSE(goals_.has_interrupted());
  EXPECT_TRUE(goals_.under_way());
  EXPECT_EQ(goals_.waiting(), 1U);
  ASSERT_TRUE(report(first, msg::kNavigatorStopped, msg::kHaltCancelled));
  EXPECT_TRUE(goals_.under_way()) << "it has another id than the cancelled one";
  goals_.interrupt();
  goals_.cancel();
  EXPECT_FALSE(goals_.has_interrupted()) << "an operator's cancel";
  static_cast<void>(drive_to_first_of_two());
  goals_.interrupt();
  static_cast<void>(drive_to_first_of_two());
  EXPECT_FALSE(goals_.has_interrupted()) << "another goal";
}

TEST_F(GoalSenderTest, AnInterruptedExplorationIsKept) {
  goals_.set_exploring(true);
  goals_.interrupt();
  goals_.set_exploring(false);
  EXPECT_TRUE(goals_.was_exploring());
  EXPECT_TRUE(goals_.has_interrupted());
}

TEST_F(GoalSenderTest, AnExplorationWaitsDuringAPause) {
  messaging::Participant localizer(messaging::options_in(partition_));
  messaging::Writer<msg::LivePose> poses(localizer);
  auto pose = messaging::message<msg::LivePose>();
  pose.state(msg::kStateTracking);
  pose.mode(msg::kModeMapping);
  ASSERT_TRUE(run_until(
      "a pose", [&] { return robot_.pose().has_value(); },
      [&] { static_cast<void>(poses.write(pose)); }));
  goals_.pause();
  ASSERT_EQ(exploration_.start().status, 202U);
  EXPECT_FALSE(goals_.is_pausing()) << "the pause of before";
  ASSERT_TRUE(run_until("a step of the exploration", [&] { return floors_ > 0; }));
  goals_.pause();
  const int before = floors_;
  int periods = 0;
  const auto timer = service_.loop().add_timer(std::chrono::milliseconds(200), [&] { ++periods; });
  ASSERT_TRUE(run_until("steps of the exploration", [&] { return periods > 3; }));
  service_.loop().cancel_timer(timer);
  EXPECT_EQ(floors_, before);
  goals_.resume();
  EXPECT_TRUE(run_until("the exploration to go on", [&] { return floors_ > before; }));
}

}  // namespace
}  // namespace topogeo::web
