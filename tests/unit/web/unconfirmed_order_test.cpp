#include "orders/unconfirmed_order.hpp"

#include <utility>

#include <gtest/gtest.h>

#include "orders/goal_list.hpp"

namespace topogeo::web {
namespace {

msg::NavigatorStatus driving(std::uint64_t goal) {
  msg::NavigatorStatus status;
  status.goal_id(goal);
  status.state(msg::kNavigatorDriving);
  return status;
}

msg::NavigatorStatus idle(std::uint64_t goal = 0) {
  msg::NavigatorStatus status;
  status.goal_id(goal);
  status.state(msg::kNavigatorIdle);
  status.reason(goal == 0 ? msg::kHaltNone : msg::kHaltCancelled);
  return status;
}

msg::NavigatorStatus paused(std::uint64_t goal) {
  msg::NavigatorStatus status = driving(goal);
  status.state(msg::kNavigatorStopped);
  status.reason(msg::kHaltPaused);
  return status;
}

msg::NavigatorStatus arrived(std::uint64_t goal, msg::HaltReason reason = msg::kHaltNone) {
  msg::NavigatorStatus status = driving(goal);
  status.state(msg::kNavigatorArrived);
  status.reason(reason);
  return status;
}

/// The repeat that follows from ten such statuses, if there is one.
std::optional<UnconfirmedOrder::Repeat> repeat_at(UnconfirmedOrder& order,
                                                  const msg::NavigatorStatus& status) {
  for (int i = 0; i < 10; ++i) {
    if (const auto repeat = order.take(status)) return repeat;
  }
  return std::nullopt;
}

TEST(UnconfirmedOrder, ACancelIsRepeatedUntilTheGoalIsGone) {
  UnconfirmedOrder order;
  EXPECT_FALSE(repeat_at(order, driving(7))) << "nothing is ordered";
  order.begin(msg::kGoalCancel, 0);
  for (int i = 0; i < 3; ++i) {
    const auto repeat = repeat_at(order, driving(7));
    ASSERT_TRUE(repeat);
    EXPECT_EQ(repeat->kind, msg::kGoalCancel);
    EXPECT_EQ(repeat->goal_id, 7U);
  }
  EXPECT_FALSE(repeat_at(order, idle(7)));
  EXPECT_FALSE(repeat_at(order, driving(7))) << "it was carried out";
}

TEST(UnconfirmedOrder, AStatusFromBeforeTheOrderNeedsNoRepeat) {
  UnconfirmedOrder order;
  order.begin(msg::kGoalCancel, 0);
  EXPECT_FALSE(order.take(driving(7)));
  EXPECT_FALSE(order.take(idle(7)));
}

TEST(UnconfirmedOrder, APauseIsRepeatedUntilTheRobotIsPaused) {
  UnconfirmedOrder order;
  order.begin(msg::kGoalPause, 7);
  const auto repeat = repeat_at(order, driving(7));
  ASSERT_TRUE(repeat);
  EXPECT_EQ(repeat->kind, msg::kGoalPause);
  EXPECT_FALSE(repeat_at(order, paused(7)));
  EXPECT_FALSE(repeat_at(order, driving(7))) << "somebody has resumed";
}

TEST(UnconfirmedOrder, APauseOutlivesTheEndOfItsGoal) {
  for (const auto& [end, confirms] :
       {std::pair{arrived(7, msg::kHaltPaused), true}, std::pair{driving(9), true},
        std::pair{arrived(7), false}, std::pair{idle(), false}}) {
    UnconfirmedOrder order;
    static_cast<void>(order.take(driving(7)));
    order.begin(msg::kGoalPause, 7);
    const auto repeat = repeat_at(order, arrived(7));
    ASSERT_TRUE(repeat);
    EXPECT_EQ(repeat->kind, msg::kGoalPause);
    EXPECT_EQ(repeat->goal_id, 7U);
    EXPECT_TRUE(order.is_pause()) << "the next goal of a list would undo it";
    EXPECT_FALSE(order.take(end));
    EXPECT_EQ(order.is_pause(), !confirms) << end.state() << " at goal " << end.goal_id();
    order.end();
    EXPECT_FALSE(order.is_pause());
  }
}

TEST(UnconfirmedOrder, APauseIsRepeatedAtAGoalReachedBefore) {
  UnconfirmedOrder order;
  static_cast<void>(order.take(arrived(7)));
  order.begin(msg::kGoalPause, 0);
  const auto repeat = repeat_at(order, arrived(7));
  ASSERT_TRUE(repeat);
  EXPECT_EQ(repeat->goal_id, 7U);
  EXPECT_FALSE(repeat_at(order, arrived(9))) << "of another client";
  EXPECT_TRUE(order.is_pause());
  EXPECT_FALSE(order.take(arrived(7, msg::kHaltPaused)));
  EXPECT_FALSE(order.is_pause());
}

TEST(UnconfirmedOrder, ACancelNeedsNoRepeatAtTheGoal) {
  UnconfirmedOrder order;
  static_cast<void>(order.take(driving(7)));
  order.begin(msg::kGoalCancel, 7);
  EXPECT_FALSE(repeat_at(order, arrived(7)));
}

// Two writers send goals and pauses, so a goal that is lost and sent again arrives after its pause.
TEST(UnconfirmedOrder, AStatusFromBeforeTheGoalConfirmsNothing) {
  for (const msg::GoalKind kind : {msg::kGoalPause, msg::kGoalCancel}) {
    for (const msg::NavigatorStatus& before : {idle(), idle(6), paused(6), driving(6)}) {
      UnconfirmedOrder order;
      static_cast<void>(order.take(before));
      order.begin(kind, 7);
      EXPECT_FALSE(order.take(before));
      EXPECT_FALSE(order.take(idle()));
      EXPECT_FALSE(order.take(driving(9))) << "of another client, before goal 7";
      const auto repeat = repeat_at(order, driving(7));
      ASSERT_TRUE(repeat);
      EXPECT_EQ(repeat->kind, kind);
      EXPECT_EQ(repeat->goal_id, 7U);
    }
  }
}

TEST(UnconfirmedOrder, AfterThreeStatusesItIsRepeatedForAGoalThatCameLate) {
  UnconfirmedOrder order;
  order.begin(msg::kGoalPause, 7);
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(order.take(idle()));
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(order.take(driving(7)));
  const auto repeat = order.take(driving(7));
  ASSERT_TRUE(repeat);
  EXPECT_EQ(repeat->kind, msg::kGoalPause);
  EXPECT_EQ(repeat->goal_id, 7U);
}

TEST(UnconfirmedOrder, AGoalThatNeverArrivesCountsAsLost) {
  UnconfirmedOrder order;
  order.begin(msg::kGoalCancel, 7);
  for (int i = 0; i < GoalList::kPatience; ++i) EXPECT_FALSE(order.take(idle()));
  EXPECT_FALSE(repeat_at(order, driving(7)));
}

TEST(UnconfirmedOrder, AnotherClientsNewerGoalIsLeftAlone) {
  UnconfirmedOrder order;
  static_cast<void>(order.take(driving(7)));
  order.begin(msg::kGoalCancel, 8);
  EXPECT_TRUE(repeat_at(order, driving(8))) << "sent before the order, taken after it";
  EXPECT_FALSE(repeat_at(order, driving(9)));
  EXPECT_FALSE(repeat_at(order, driving(8)));
}

TEST(UnconfirmedOrder, AGoalOrAResumeEndsIt) {
  UnconfirmedOrder order;
  order.begin(msg::kGoalPause, 7);
  order.end();
  EXPECT_FALSE(repeat_at(order, driving(7)));
}

}  // namespace
}  // namespace topogeo::web
