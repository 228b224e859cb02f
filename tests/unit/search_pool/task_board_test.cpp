// Distribution of tasks, and the handling of workers that leave.
#include <string>
#include <utility>
#include <vector>

#include "board_fixture.hpp"

namespace topogeo::search_pool {
namespace {

TEST_F(TaskBoardTest, WithoutWorkersEverythingIsSolvedHereAtOnce) {
  begin(3);
  EXPECT_THAT(send_all(seconds(0)), IsEmpty());
  EXPECT_THAT(local(seconds(0)), ElementsAre(0U, 1U, 2U));
  expect_results(3);
  EXPECT_EQ(board_.counts().in_process, 3U);
  EXPECT_EQ(board_.counts().sent, 0U);
}

TEST_F(TaskBoardTest, AnEmptyBatchIsDone) {
  begin(0);
  expect_results(0);
}

TEST_F(TaskBoardTest, SlotsAreRespectedAndTasksSpreadEvenly) {
  up("a", 1);
  up("b", 2);
  begin(8);
  // The lowest load per slot first: 2 tasks for one slot, 4 for two.
  EXPECT_THAT(send_all(seconds(0)),
              ElementsAre(std::pair{0U, "a"}, std::pair{1U, "b"}, std::pair{2U, "b"},
                          std::pair{3U, "a"}, std::pair{4U, "b"}, std::pair{5U, "b"}));
  EXPECT_THAT(local(seconds(0)), IsEmpty()) << "workers are there: the rest waits for them";
  EXPECT_EQ(answer("b", 1, milliseconds(2)), Reception::kFirst);
  EXPECT_THAT(send_all(milliseconds(2)), ElementsAre(std::pair{6U, "b"}));
}

/// Number of tasks that are sent at once.
int sent_at_once(TaskBoard& board) {
  int count = 0;
  while (board.next_remote(seconds(0))) ++count;
  return count;
}

TEST(TaskBoard, WorkersHoldHalfOfTheirShareOfABatch) {
  BoardConfig config;
  config.probation = 0;
  for (const auto& [batch, sent] : {std::pair{4, 4}, std::pair{8, 4}, std::pair{12, 6},
                                    std::pair{100, 50}, std::pair{1000, 128}}) {
    TaskBoard board(config);
    for (const char* worker : {"a", "b"}) {
      board.worker_up(worker, 1, seconds(0));
      board.set_reachable(worker, true);
    }
    board.begin(tasks(static_cast<std::size_t>(batch)));
    EXPECT_EQ(sent_at_once(board), sent) << "of " << batch;
  }
}

TEST(TaskBoard, ANewWorkerHoldsTwoTasksBeforeItsProbationIsOver) {
  TaskBoard board;
  board.worker_up("a", 1, seconds(0));
  board.set_reachable("a", true);
  board.begin(tasks(100, 100));
  EXPECT_EQ(sent_at_once(board), 2);
  for (const auto& [task_id, next] :
       {std::pair{100U, 1}, std::pair{101U, 1}, std::pair{102U, 47}}) {
    board.answer("a", answer_to(task_id), seconds(0));
    EXPECT_EQ(sent_at_once(board), next) << task_id;
  }
}

TEST_F(TaskBoardTest, ResultsComeInTheOrderOfTheTasks) {
  up("a");
  up("b");
  begin(4);
  send_all(seconds(0));
  for (const auto& [worker, task] :
       {std::pair{"b", 3U}, std::pair{"a", 2U}, std::pair{"b", 1U}, std::pair{"a", 0U}}) {
    EXPECT_FALSE(board_.done());
    EXPECT_EQ(answer(worker, task, milliseconds(5)), Reception::kFirst);
  }
  expect_results(4);
}

TEST_F(TaskBoardTest, TasksOfALostWorkerGoToAnotherAtOnce) {
  up("a");
  up("b");
  begin(4);
  send_all(seconds(0));
  board_.worker_gone("a");
  EXPECT_EQ(board_.counts().workers_lost, 1U);
  EXPECT_THAT(send_all(milliseconds(1)), IsEmpty()) << "b has enough";
  answer("b", 1, milliseconds(2));
  answer("b", 3, milliseconds(3));
  EXPECT_THAT(send_all(milliseconds(3)), ElementsAre(std::pair{0U, "b"}, std::pair{2U, "b"}));
  EXPECT_EQ(board_.counts().resent, 2U);
  answer("b", 0, milliseconds(4));
  answer("b", 2, milliseconds(5));
  expect_results(4);
}

TEST_F(TaskBoardTest, WhenAllWorkersVanishTheRestIsSolvedHere) {
  up("a");
  up("b");
  begin(6);
  send_all(seconds(0));
  answer("a", 0, milliseconds(2));
  board_.worker_gone("a");
  board_.worker_gone("b");
  EXPECT_THAT(send_all(milliseconds(3)), IsEmpty());
  EXPECT_THAT(local(milliseconds(3)), ElementsAre(1U, 2U, 3U, 4U, 5U));
  expect_results(6);
}

TEST_F(TaskBoardTest, AWorkerThatWasGoneAndIsBackHasLostItsTasks) {
  up("a");
  begin(1);
  send_all(seconds(0));
  up("a");
  EXPECT_THAT(send_all(milliseconds(1)), IsEmpty()) << "it only reports so again";
  board_.worker_gone("a");
  up("a");
  EXPECT_THAT(send_all(milliseconds(2)), ElementsAre(std::pair{0U, "a"}));
  EXPECT_EQ(board_.counts().workers_lost, 1U);
}

TEST_F(TaskBoardTest, ALateWorkerGetsTasksOfTheRunningBatch) {
  up("a");
  begin(5);
  EXPECT_EQ(send_all(seconds(0)).size(), 2U);
  up("b");
  EXPECT_THAT(send_all(milliseconds(1)), ElementsAre(std::pair{2U, "b"}, std::pair{3U, "b"}));
}

TEST_F(TaskBoardTest, AWorkerIsUsedOnlyOnceItCanBeReached) {
  board_.worker_up("a", 1, seconds(0));
  EXPECT_EQ(board_.workers(), 0U);
  begin(1);
  EXPECT_THAT(send_all(seconds(0)), IsEmpty());
  board_.set_reachable("a", true);
  EXPECT_EQ(board_.workers(), 1U);
  EXPECT_THAT(send_all(seconds(0)), ElementsAre(std::pair{0U, "a"}));
}

TEST_F(TaskBoardTest, ADrainingWorkerGetsNothingNewButMayFinish) {
  up("a");
  begin(3);
  EXPECT_EQ(send_all(seconds(0)).size(), 2U);
  up("a", 0);
  EXPECT_EQ(board_.workers(), 0U);
  EXPECT_EQ(answer("a", 0, milliseconds(2)), Reception::kFirst);
  EXPECT_THAT(send_all(milliseconds(2)), IsEmpty());
  EXPECT_THAT(local(milliseconds(2)), ElementsAre(2U));
  EXPECT_EQ(answer("a", 1, milliseconds(3)), Reception::kFirst);
  expect_results(3);
}

}  // namespace
}  // namespace topogeo::search_pool
