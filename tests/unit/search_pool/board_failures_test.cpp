// Workers that hang, refuse, answer twice or lose tasks.
#include <cstdint>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "board_fixture.hpp"

namespace topogeo::search_pool {
namespace {

TEST_F(TaskBoardTest, AStragglerIsGivenToAnotherWorkerAndTheFirstAnswerWins) {
  up("a");
  begin(1);
  send_all(seconds(0));
  up("b");
  EXPECT_EQ(board_.next_deadline(milliseconds(1)), BoardTime(milliseconds(250)));
  EXPECT_THAT(send_all(milliseconds(249)), IsEmpty());
  EXPECT_THAT(send_all(milliseconds(250)), ElementsAre(std::pair{0U, "b"}));
  EXPECT_THAT(local(milliseconds(250)), IsEmpty());
  EXPECT_EQ(answer("b", 0, milliseconds(253)), Reception::kFirst);
  expect_results(1);
  EXPECT_EQ(answer("a", 0, milliseconds(1200)), Reception::kDuplicate) << "also after the batch";
  EXPECT_EQ(board_.counts().resent, 1U);
  EXPECT_EQ(board_.counts().duplicates, 1U);
  EXPECT_EQ(board_.counts().duplicate_differences, 0U);
}

TEST_F(TaskBoardTest, AStragglerWithoutAnotherWorkerIsSolvedHere) {
  up("a");
  begin(4);
  send_all(seconds(0));
  EXPECT_THAT(local(milliseconds(249)), IsEmpty());
  EXPECT_THAT(local(milliseconds(250)), ElementsAre(2U, 3U, 0U, 1U))
      << "tasks that wait for a worker that hangs are solved here as well";
  expect_results(4);
  first_id_ = 200;
  begin(1);
  EXPECT_THAT(send_all(milliseconds(1010)), IsEmpty()) << "it still hangs";
  EXPECT_THAT(local(milliseconds(1010)), ElementsAre(0U));
  expect_results(1);
  first_id_ = 100;
  EXPECT_EQ(answer("a", 0, milliseconds(1100)), Reception::kDuplicate);
  EXPECT_EQ(answer("a", 1, milliseconds(1100)), Reception::kDuplicate);
  first_id_ = 300;
  begin(1);
  EXPECT_THAT(send_all(milliseconds(1101)), ElementsAre(std::pair{0U, "a"})) << "it is back";
}

TEST_F(TaskBoardTest, TheTimeOfAStragglerFollowsSlowTasks) {
  up("a");
  begin(2);
  send_all(seconds(0));
  answer("a", 0, milliseconds(900));  // 20 x 0.9 s = 18 s
  up("b");
  EXPECT_THAT(send_all(milliseconds(17'999)), IsEmpty());
  EXPECT_THAT(send_all(milliseconds(18'000)), ElementsAre(std::pair{1U, "b"}));
}

TEST_F(TaskBoardTest, AWorkerThatNeverAnswersIsTriedEverMoreSeldom) {
  up("a");
  const auto tried_at = [&](BoardTime now) {
    first_id_ += 100;
    begin(2);
    const bool tried = !send_all(now).empty();
    board_.abandon();
    return tried;
  };
  BoardTime sent{0};
  ASSERT_TRUE(tried_at(sent));
  for (const int pause_s : {2, 4, 8, 16, 30, 30}) {
    sent += seconds(pause_s);
    EXPECT_FALSE(tried_at(sent - milliseconds(1))) << pause_s;
    EXPECT_TRUE(tried_at(sent)) << pause_s;
  }
  answer("a", 0, sent + milliseconds(1));
  EXPECT_FALSE(tried_at(sent + seconds(2) - milliseconds(1))) << "it owes the other answer";
  EXPECT_TRUE(tried_at(sent + seconds(2))) << "it has answered meanwhile";
}

// If a robot begins before its workers can send answers, it loses one answer of each.
TEST_F(TaskBoardTest, WorkersOfWhichEachOwesAnAnswerAreSoonUsedAgain) {
  constexpr std::size_t kWorkers = 64;
  for (std::size_t i = 0; i < kWorkers; ++i) up("worker" + std::to_string(i));
  begin(kWorkers);
  EXPECT_EQ(send_all(seconds(0)).size(), kWorkers);
  EXPECT_EQ(local(milliseconds(250)).size(), kWorkers) << "none has answered";
  expect_results(kWorkers);
  std::size_t here = 0;
  BoardTime now = milliseconds(300);
  for (; now < seconds(10); now += milliseconds(20)) {
    first_id_ += 100;
    begin(12);
    for (const auto& [task, worker] : send_all(now)) answer(worker, task, now + milliseconds(5));
    here += local(now + milliseconds(5)).size();
    expect_results(12);
  }
  EXPECT_EQ(here, 12U * (2000 - 300) / 20) << "all of two seconds, and none later";
}

TEST_F(TaskBoardTest, AnAnswerThatNobodyAskedForIsIgnored) {
  up("a");
  begin(1);
  EXPECT_EQ(answer("a", 7, seconds(0)), Reception::kUnknown);
  EXPECT_FALSE(board_.done());
  EXPECT_EQ(board_.counts().duplicates, 0U);
}

TEST_F(TaskBoardTest, AnAnswerFromAWorkerThatWasNotAskedIsIgnored) {
  up("a");
  begin(1);
  send_all(seconds(0));
  up("b");
  EXPECT_EQ(answer("b", 0, milliseconds(1)), Reception::kUnknown);
  EXPECT_FALSE(board_.done());
  EXPECT_EQ(answer("a", 0, milliseconds(1)), Reception::kFirst);
  EXPECT_EQ(answer("b", 0, milliseconds(2)), Reception::kUnknown);
  EXPECT_EQ(board_.counts().ignored, 2U);
}

TEST_F(TaskBoardTest, TheAnswerOfAWorkerThatWasGivenUpCounts) {
  up("a");
  up("b");
  begin(2);
  send_all(seconds(0));
  board_.worker_gone("a");
  EXPECT_THAT(send_all(milliseconds(1)), ElementsAre(std::pair{0U, "b"}));
  EXPECT_EQ(answer("a", 0, milliseconds(2)), Reception::kFirst);
  EXPECT_EQ(answer("b", 0, milliseconds(3)), Reception::kDuplicate);
}

TEST_F(TaskBoardTest, AnExcludedWorkerIsNotUsedAgain) {
  up("a");
  up("b");
  begin(2);
  EXPECT_THAT(send_all(seconds(0)), ElementsAre(std::pair{0U, "a"}, std::pair{1U, "b"}));
  EXPECT_TRUE(board_.exclude("a", milliseconds(1)));
  EXPECT_FALSE(board_.exclude("a", milliseconds(1))) << "it is excluded already";
  EXPECT_TRUE(board_.is_excluded("a"));
  EXPECT_EQ(board_.workers(), 1U);
  EXPECT_THAT(send_all(milliseconds(1)), ElementsAre(std::pair{0U, "b"}));
  board_.worker_gone("a");
  up("a");
  EXPECT_EQ(board_.workers(), 1U) << "not even when it comes back";
  EXPECT_EQ(answer("a", 0, milliseconds(2)), Reception::kUnknown);
  EXPECT_EQ(board_.counts().workers_excluded, 1U);
}

TEST_F(TaskBoardTest, ATaskWhoseMapIsMissingGoesElsewhereAndTheWorkerRests) {
  up("a");
  up("b");
  begin(3);
  send_all(seconds(0));
  answer("b", 1, milliseconds(1));
  board_.refuse("a", first_id_, Refusal::kMapMissing, milliseconds(2));
  EXPECT_THAT(send_all(milliseconds(2)), ElementsAre(std::pair{0U, "b"}));
  answer("b", 0, milliseconds(3));
  answer("a", 2, milliseconds(3));
  expect_results(3);
  EXPECT_EQ(board_.counts().map_missing, 1U);
  first_id_ = 200;
  begin(2);
  EXPECT_THAT(send_all(milliseconds(5001)), ElementsAre(std::pair{0U, "b"}, std::pair{1U, "b"}));
  answer("b", 0, milliseconds(5002));
  answer("b", 1, milliseconds(5002));
  expect_results(2);
  first_id_ = 300;
  begin(1);
  EXPECT_THAT(send_all(milliseconds(5002)), ElementsAre(std::pair{0U, "a"})) << "rested";
}

TEST_F(TaskBoardTest, ATaskWhoseMapIsMissingEverywhereIsSolvedHere) {
  up("a");
  begin(1);
  send_all(seconds(0));
  board_.refuse("a", first_id_, Refusal::kMapMissing, seconds(0));
  EXPECT_THAT(send_all(seconds(0)), IsEmpty());
  EXPECT_THAT(local(seconds(0)), ElementsAre(0U));
  expect_results(1);
}

TEST_F(TaskBoardTest, ATaskThatFailsIsTriedOnceMoreHereToLearnWhy) {
  up("a");
  up("b");
  begin(1);
  send_all(seconds(0));
  board_.refuse("a", first_id_, Refusal::kFailed, milliseconds(1));
  EXPECT_THAT(send_all(milliseconds(1)), IsEmpty());
  EXPECT_THAT(local(milliseconds(1)), ElementsAre(0U));
  EXPECT_EQ(board_.counts().failed, 1U);
}

TEST_F(TaskBoardTest, ATaskThatCouldNotBeSentGoesElsewhere) {
  up("a");
  up("b");
  begin(1);
  const auto first = board_.next_remote(seconds(0));
  ASSERT_TRUE(first);
  board_.not_sent(*first, seconds(0));
  EXPECT_THAT(send_all(seconds(0)), ElementsAre(std::pair{0U, "b"}));
  EXPECT_EQ(board_.counts().sent, 1U);
  EXPECT_EQ(board_.counts().resent, 0U);
}

TEST_F(TaskBoardTest, AnAbandonedBatchLeavesRoomForTheNext) {
  up("a", 2);
  begin(2);
  send_all(seconds(0));
  board_.abandon();
  first_id_ = 200;
  begin(4);
  EXPECT_EQ(send_all(milliseconds(1)).size(), 2U) << "it still works on the others";
  EXPECT_EQ(board_.answer("a", answer_to(100), milliseconds(2)), Reception::kUnknown);
  EXPECT_EQ(send_all(milliseconds(2)).size(), 1U);
}

TEST_F(TaskBoardTest, MisuseIsAnError) {
  begin(1);
  EXPECT_THROW(begin(1), std::logic_error);
  EXPECT_THROW(board_.take_results(), std::logic_error);
  board_.abandon();
  std::vector<MatchTask> twice = tasks(2);
  twice[1].task_id = twice[0].task_id;
  EXPECT_THROW(board_.begin(twice), std::logic_error);
  EXPECT_TRUE(board_.done());
}

// Every task gets its single right answer, in order, under random failures of workers and with one
// in ten answers wrong.
TEST_F(TaskBoardTest, EveryBatchEndsUnderRandomFailures) {
  BoardConfig options;
  options.audit_every = 1;
  board_ = TaskBoard(options);
  std::uint64_t state = 12345;
  const auto random = [&state](std::uint64_t below) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return (state >> 33) % below;
  };
  BoardTime now{0};
  std::vector<std::pair<std::string, std::uint64_t>> in_hand;
  std::map<std::string, int> lives;
  // An excluded worker returns with a new id.
  const auto id_of = [&](const std::string& name) {
    while (board_.is_excluded(name + std::to_string(lives[name]))) ++lives[name];
    return name + std::to_string(lives[name]);
  };
  const auto take_answer = [&](const std::string& worker, std::uint64_t task_id) {
    MatchResult result = answer_to(task_id);
    if (random(10) == 0) result.fitness = 0.5;
    if (board_.answer(worker, result, now) != Reception::kDifferent) return;
    EXPECT_GE(board_.settle(answer_to(task_id), now).size(), 1U);
  };
  for (int batch = 0; batch < 300; ++batch) {
    const std::size_t count = 1 + random(12);
    begin(count);
    int rounds = 0;
    while (!board_.done()) {
      ASSERT_LT(++rounds, 10'000);
      now += milliseconds(random(300));
      const std::string worker = id_of(std::string(1, static_cast<char>('a' + random(4))));
      const std::uint64_t event = random(10);
      if (event < 3) up(worker, static_cast<std::uint32_t>(random(3)), now);
      if (event == 3) board_.worker_gone(worker);
      while (const auto next = board_.next_remote(now)) {
        in_hand.emplace_back(next->worker_id, first_id_ + next->task);
      }
      if (const auto here = board_.next_local(now)) {
        board_.solved(*here, answer_to(first_id_ + *here), now);
      }
      audit(now);
      if (in_hand.empty() || event == 4) continue;
      const auto chosen = in_hand.begin() + static_cast<std::ptrdiff_t>(random(in_hand.size()));
      const auto [from, task_id] = *chosen;
      in_hand.erase(chosen);
      if (event == 5) {
        board_.refuse(from, task_id, Refusal::kMapMissing, now);
      } else if (event != 6) {  // 6: the answer is lost
        take_answer(from, task_id);
      }
    }
    expect_results(count);
    first_id_ += count;
  }
  EXPECT_GT(board_.counts().duplicates, 0U);
  EXPECT_GT(board_.counts().duplicate_differences, 0U);
  EXPECT_GT(board_.counts().audit_differences, 0U);
  EXPECT_GT(board_.counts().redone + board_.counts().workers_excluded, 0U);
  EXPECT_GT(board_.counts().in_process, 0U);
  EXPECT_GT(board_.counts().resent, 0U);
}

}  // namespace
}  // namespace topogeo::search_pool
