// A board with tasks that have known answers.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/matching/match.hpp"
#include "topogeo/search_pool/task_board.hpp"

namespace topogeo::search_pool {
using localization::MatchResult;
using localization::MatchTask;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Sent = std::vector<std::pair<std::size_t, std::string>>;

inline std::vector<MatchTask> tasks(std::size_t count, std::uint64_t first_id = 100) {
  std::vector<MatchTask> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i].task_id = first_id + i;
  return result;
}

/// A matcher's answer, which depends on the task alone.
inline MatchResult answer_to(std::uint64_t task_id) {
  MatchResult result;
  result.task_id = task_id;
  result.status = localization::MatchStatus::kSolved;
  result.overlap = 0.001 * static_cast<double>(task_id);
  return result;
}

class TaskBoardTest : public ::testing::Test {
 protected:
  void up(const std::string& worker, std::uint32_t slots = 1, BoardTime now = seconds(0)) {
    board_.worker_up(worker, slots, now);
    board_.set_reachable(worker, true);
  }
  Sent send_all(BoardTime now) {
    Sent sent;
    while (const auto next = board_.next_remote(now))
      sent.emplace_back(next->task, next->worker_id);
    return sent;
  }
  std::vector<std::size_t> local(BoardTime now) {
    std::vector<std::size_t> solved;
    while (const auto next = board_.next_local(now)) {
      solved.push_back(*next);
      board_.solved(*next, answer_to(first_id_ + *next), now);
    }
    return solved;
  }
  /// Compares pending duplicates; returns the tasks, and the erring workers in `differences_`.
  std::vector<std::size_t> audit(BoardTime now) {
    std::vector<std::size_t> compared;
    while (const auto next = board_.next_audit()) {
      compared.push_back(*next);
      for (auto& difference : board_.settle(answer_to(first_id_ + *next), now)) {
        differences_.push_back(std::move(difference));
      }
    }
    return compared;
  }
  Reception answer(const std::string& worker, std::size_t task, BoardTime now) {
    return board_.answer(worker, answer_to(first_id_ + task), now);
  }
  void begin(std::size_t count) { board_.begin(tasks(count, first_id_)); }
  void expect_results(std::size_t count) {
    ASSERT_TRUE(board_.done());
    const std::vector<MatchResult> results = board_.take_results();
    ASSERT_EQ(results.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      EXPECT_TRUE(identical(results[i], answer_to(first_id_ + i))) << i;
    }
  }

  static BoardConfig without_audits() {
    BoardConfig options;
    options.probation = 0;
    options.audit_every = 0;
    return options;
  }

  std::uint64_t first_id_ = 100;
  TaskBoard board_{without_audits()};
  std::vector<TaskBoard::Difference> differences_;
};

}  // namespace topogeo::search_pool
