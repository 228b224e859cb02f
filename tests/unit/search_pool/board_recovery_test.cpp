// Time until other workers have answered the tasks of a failed one.
#include <string>
#include <utility>
#include <vector>

#include "board_fixture.hpp"

namespace topogeo::search_pool {
namespace {

TEST_F(TaskBoardTest, ALostWorkerIsMeasuredFromItsLastSignOfLife) {
  up("a", 1, seconds(0));
  up("b", 1, seconds(0));
  begin(5);
  send_all(seconds(0));  // a: 0 and 2; b: 1 and 3
  up("a", 1, milliseconds(40));
  answer("a", 0, milliseconds(60));
  send_all(milliseconds(60));  // a: 2 and 4
  answer("b", 1, milliseconds(100));
  answer("b", 3, milliseconds(100));
  board_.worker_gone("a");
  send_all(milliseconds(100));
  answer("b", 2, milliseconds(110));
  EXPECT_THAT(board_.take_recoveries(), IsEmpty());
  answer("b", 4, milliseconds(160));
  const std::vector<Recovery> recoveries = board_.take_recoveries();
  ASSERT_EQ(recoveries.size(), 1U);
  EXPECT_EQ(recoveries[0].worker_id, "a");
  EXPECT_EQ(recoveries[0].fault, WorkerFault::kLost);
  EXPECT_EQ(recoveries[0].tasks, 2U);
  EXPECT_EQ(recoveries[0].duration, BoardTime(milliseconds(100)));
  EXPECT_EQ(board_.counts().last_recovery, BoardTime(milliseconds(100)));
  EXPECT_EQ(board_.counts().longest_recovery, BoardTime(milliseconds(100)));
  EXPECT_THAT(board_.take_recoveries(), IsEmpty()) << "reported once";
}

TEST_F(TaskBoardTest, AStalledWorkerIsMeasuredFromWhenItGotItsTask) {
  up("a");
  begin(2);
  send_all(milliseconds(10));
  up("b", 1, milliseconds(20));
  send_all(milliseconds(260));
  answer("b", 0, milliseconds(270));
  answer("b", 1, milliseconds(280));
  const std::vector<Recovery> recoveries = board_.take_recoveries();
  ASSERT_EQ(recoveries.size(), 1U);
  EXPECT_EQ(recoveries[0].fault, WorkerFault::kStalled);
  EXPECT_EQ(recoveries[0].tasks, 2U);
  EXPECT_EQ(recoveries[0].duration, BoardTime(milliseconds(270)));
}

TEST_F(TaskBoardTest, AWorkerThatWasSlowOnlyNeedsNoRecovery) {
  up("a");
  begin(1);
  send_all(seconds(0));
  up("b");
  send_all(milliseconds(250));
  answer("a", 0, milliseconds(260));
  EXPECT_THAT(board_.take_recoveries(), IsEmpty());
  EXPECT_EQ(board_.counts().last_recovery, BoardTime(0));
}

TEST_F(TaskBoardTest, AnswersOfThisProcessAreARecoveryToo) {
  up("a", 1, milliseconds(5));
  begin(1);
  send_all(milliseconds(5));
  board_.worker_gone("a");
  local(milliseconds(30));
  const std::vector<Recovery> recoveries = board_.take_recoveries();
  ASSERT_EQ(recoveries.size(), 1U);
  EXPECT_EQ(recoveries[0].duration, BoardTime(milliseconds(25)));
}

TEST_F(TaskBoardTest, TasksOfAnExcludedWorkerAreARecoveryFromThen) {
  up("a");
  begin(2);
  send_all(seconds(0));
  answer("a", 0, milliseconds(1));
  board_.distrust("a", milliseconds(2));
  local(milliseconds(5));
  const std::vector<Recovery> recoveries = board_.take_recoveries();
  ASSERT_EQ(recoveries.size(), 1U);
  EXPECT_EQ(recoveries[0].fault, WorkerFault::kExcluded);
  EXPECT_EQ(recoveries[0].tasks, 2U) << "one in hand and one to be done again";
  EXPECT_EQ(recoveries[0].duration, BoardTime(milliseconds(3)));
}

TEST_F(TaskBoardTest, AWorkerThatLeavesInOrderNeedsNoRecovery) {
  up("a");
  begin(1);
  send_all(seconds(0));
  up("a", 0);
  answer("a", 0, milliseconds(1));
  board_.worker_gone("a");
  EXPECT_THAT(board_.take_recoveries(), IsEmpty());
  EXPECT_EQ(board_.counts().workers_lost, 0U);
}

TEST(RecoveryWatch, TheSameWorkerTwiceIsOneCase) {
  RecoveryWatch watch;
  watch.begin("a", WorkerFault::kStalled, milliseconds(10), {1});
  watch.begin("a", WorkerFault::kLost, milliseconds(20), {1, 2});
  watch.answered(1, "b", milliseconds(30));
  watch.answered(3, "b", milliseconds(35));
  EXPECT_THAT(watch.take(), IsEmpty());
  watch.answered(2, "a", milliseconds(50));
  const std::vector<Recovery> recoveries = watch.take();
  ASSERT_EQ(recoveries.size(), 1U);
  EXPECT_EQ(recoveries[0].fault, WorkerFault::kLost);
  EXPECT_EQ(recoveries[0].tasks, 2U);
  EXPECT_EQ(recoveries[0].duration, BoardTime(milliseconds(40)));
}

TEST(RecoveryWatch, AWorkerWithoutTasksIsNoCase) {
  RecoveryWatch watch;
  watch.begin("a", WorkerFault::kLost, milliseconds(10), {});
  watch.answered(1, "b", milliseconds(30));
  EXPECT_THAT(watch.take(), IsEmpty());
}

TEST(RecoveryWatch, AnAbandonedBatchIsNotWaitedFor) {
  RecoveryWatch watch;
  watch.begin("a", WorkerFault::kLost, milliseconds(10), {1});
  watch.abandon();
  watch.answered(1, "b", milliseconds(30));
  EXPECT_THAT(watch.take(), IsEmpty());
}

}  // namespace
}  // namespace topogeo::search_pool
