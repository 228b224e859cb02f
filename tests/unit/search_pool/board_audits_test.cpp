// Answers that are compared with this process's own results.
#include <string>
#include <utility>
#include <vector>

#include "board_fixture.hpp"

namespace topogeo::search_pool {
namespace {

/// A wrong answer to the same task.
MatchResult other_answer_to(std::uint64_t task_id) {
  MatchResult other = answer_to(task_id);
  other.covariance(2, 1) = 1e-300;
  return other;
}

class AuditTest : public TaskBoardTest {
 protected:
  void use(std::uint32_t probation, std::uint32_t audit_every) {
    BoardConfig options;
    options.probation = probation;
    options.audit_every = audit_every;
    board_ = TaskBoard(options);
  }
  Reception wrong_answer(const std::string& worker, std::size_t task, BoardTime now) {
    return board_.answer(worker, other_answer_to(first_id_ + task), now);
  }
};

TEST_F(AuditTest, TheFirstAnswersOfEveryWorkerAreCompared) {
  use(3, 0);
  up("a", 4);
  begin(8);
  send_all(seconds(0));
  for (std::size_t i = 0; i < 8; ++i) answer("a", i, milliseconds(1));
  EXPECT_FALSE(board_.done()) << "the comparison belongs to the batch";
  EXPECT_THAT(audit(milliseconds(2)), ElementsAre(0U, 1U, 2U));
  expect_results(8);
  EXPECT_THAT(differences_, IsEmpty());
  EXPECT_EQ(board_.counts().audits, 3U);
  first_id_ = 200;
  up("b", 1);
  begin(10);
  send_all(milliseconds(3));
  answer("a", 0, milliseconds(4));
  answer("b", 1, milliseconds(4));
  EXPECT_THAT(audit(milliseconds(5)), ElementsAre(1U)) << "b is new";
}

TEST_F(AuditTest, AfterThatOneInSoManyIsComparedChosenByTheTask) {
  use(0, 64);
  up("a", 50);
  const auto compared_of = [&](std::uint64_t first_id) {
    std::vector<std::size_t> compared;
    for (first_id_ = first_id; first_id_ < first_id + 6400; first_id_ += 100) {
      begin(100);
      send_all(seconds(0));
      for (std::size_t i = 0; i < 100; ++i) answer("a", i, milliseconds(1));
      for (const std::size_t i : audit(milliseconds(1))) compared.push_back(first_id_ + i);
      expect_results(100);
    }
    return compared;
  };
  const std::vector<std::size_t> compared = compared_of(0);
  EXPECT_GT(compared.size(), 60U) << "6400 / 64, more or less";
  EXPECT_LT(compared.size(), 150U);
  EXPECT_EQ(compared_of(0), compared) << "the same ones in every run";
  EXPECT_NE(compared_of(6400).front() - 6400, compared.front());
}

TEST_F(AuditTest, ADifferentAnswerCostsAWorkerAllThatItAnsweredInTheBatch) {
  use(1, 0);
  up("a", 3);
  up("b", 1);
  begin(6);
  EXPECT_THAT(send_all(seconds(0)),
              ElementsAre(std::pair{0U, "a"}, std::pair{1U, "b"}, std::pair{2U, "a"},
                          std::pair{3U, "a"}, std::pair{4U, "a"}, std::pair{5U, "b"}));
  answer("b", 5, milliseconds(1));
  EXPECT_EQ(wrong_answer("a", 0, milliseconds(1)), Reception::kFirst);
  EXPECT_EQ(answer("a", 2, milliseconds(1)), Reception::kFirst);
  EXPECT_EQ(wrong_answer("a", 3, milliseconds(1)), Reception::kFirst);
  EXPECT_EQ(answer("b", 1, milliseconds(1)), Reception::kFirst);
  EXPECT_THAT(audit(milliseconds(2)), ElementsAre(0U, 5U)) << "the first of a and of b";
  ASSERT_EQ(differences_.size(), 1U);
  EXPECT_EQ(differences_[0].worker_id, "a");
  EXPECT_TRUE(identical(differences_[0].answer, other_answer_to(100)));
  EXPECT_TRUE(board_.is_excluded("a"));
  EXPECT_EQ(board_.counts().audit_differences, 1U);
  EXPECT_EQ(board_.counts().redone, 2U) << "task 0 has the answer that was made here";
  EXPECT_EQ(wrong_answer("a", 4, milliseconds(2)), Reception::kUnknown);
  // a had answered 2 and 3, and held 4.
  EXPECT_THAT(send_all(milliseconds(2)), ElementsAre(std::pair{2U, "b"}, std::pair{3U, "b"}));
  answer("b", 2, milliseconds(3));
  answer("b", 3, milliseconds(3));
  EXPECT_THAT(send_all(milliseconds(3)), ElementsAre(std::pair{4U, "b"}));
  answer("b", 4, milliseconds(4));
  expect_results(6);
}

TEST_F(AuditTest, WhatWasComparedBeforeStaysWhenTheWorkerErrsLater) {
  use(1, 0);
  up("a", 2);
  begin(3);
  send_all(seconds(0));
  answer("a", 0, milliseconds(1));
  audit(milliseconds(1));
  answer("a", 1, milliseconds(2));
  EXPECT_TRUE(board_.distrust("a", milliseconds(3))) << "for a wrong answer";
  EXPECT_FALSE(board_.distrust("a", milliseconds(3)));
  EXPECT_EQ(board_.counts().redone, 1U);
  EXPECT_THAT(local(milliseconds(3)), ElementsAre(1U, 2U));
  expect_results(3);
}

TEST_F(AuditTest, AnExclusionForItsVersionKeepsAWorkersAnswers) {
  up("a", 2);
  begin(2);
  send_all(seconds(0));
  answer("a", 0, milliseconds(1));
  board_.exclude("a", milliseconds(2));
  EXPECT_THAT(local(milliseconds(2)), ElementsAre(1U));
  expect_results(2);
}

TEST_F(AuditTest, WhenTwoWorkersDifferThisProcessDecides) {
  for (const bool first_errs : {true, false}) {
    board_ = TaskBoard(without_audits());
    differences_.clear();
    up("a");
    begin(2);
    send_all(seconds(0));
    up("b");
    ASSERT_EQ(send_all(seconds(1)).size(), 2U) << "both to b as well";
    const auto give = [&](const std::string& worker, bool errs) {
      return errs ? wrong_answer(worker, 0, milliseconds(1001))
                  : answer(worker, 0, milliseconds(1001));
    };
    EXPECT_EQ(give("a", first_errs), Reception::kFirst);
    EXPECT_EQ(give("b", !first_errs), Reception::kDifferent);
    const std::string guilty = first_errs ? "a" : "b";
    const std::string honest = first_errs ? "b" : "a";
    const auto differences = board_.settle(answer_to(first_id_), milliseconds(1002));
    ASSERT_EQ(differences.size(), 1U);
    EXPECT_EQ(differences[0].worker_id, guilty);
    EXPECT_TRUE(board_.is_excluded(guilty));
    EXPECT_FALSE(board_.is_excluded(honest));
    EXPECT_EQ(answer(honest, 1, milliseconds(1003)), Reception::kFirst);
    expect_results(2);
    EXPECT_EQ(board_.counts().duplicates, 1U);
    EXPECT_EQ(board_.counts().duplicate_differences, 1U);
  }
}

TEST_F(AuditTest, ALateAnswerIsComparedAfterItsBatch) {
  up("a");
  begin(2);
  send_all(seconds(0));
  board_.worker_gone("a");
  local(milliseconds(1));
  expect_results(2);
  EXPECT_EQ(answer("a", 0, seconds(2)), Reception::kDuplicate);
  EXPECT_EQ(wrong_answer("a", 1, seconds(2)), Reception::kDifferent);
  ASSERT_NE(board_.given("a", first_id_ + 1), nullptr) << "to solve it again";
  EXPECT_EQ(board_.given("b", first_id_ + 1), nullptr);
  const auto differences = board_.settle(answer_to(first_id_ + 1), seconds(2));
  ASSERT_EQ(differences.size(), 1U);
  EXPECT_EQ(differences[0].worker_id, "a");
  up("a");
  EXPECT_EQ(board_.workers(), 0U);
}

TEST_F(AuditTest, ReportsHowManyAnswersOfAnErringWorkerStand) {
  use(1, 0);
  up("a", 2);
  begin(4);
  send_all(seconds(0));
  for (std::size_t i = 0; i < 4; ++i) answer("a", i, milliseconds(1));
  audit(milliseconds(1));
  expect_results(4);
  first_id_ = 200;
  begin(1);
  send_all(seconds(1));
  up("b");
  send_all(seconds(2));
  wrong_answer("a", 0, milliseconds(2001));
  answer("b", 0, milliseconds(2002));
  const auto differences = board_.settle(answer_to(first_id_), milliseconds(2002));
  ASSERT_EQ(differences.size(), 1U);
  EXPECT_EQ(differences[0].unchecked, 3U) << "one of the four was compared";
}

}  // namespace
}  // namespace topogeo::search_pool
