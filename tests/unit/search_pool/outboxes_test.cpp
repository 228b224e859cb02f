#include "topogeo/search_pool/outboxes.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace topogeo::search_pool {
namespace {

using std::chrono::milliseconds;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Optional;

class OutboxesTest : public ::testing::Test {
 protected:
  using Time = Outboxes<int>::Time;

  static constexpr Time at(int ms) { return Time{} + std::chrono::hours(1) + milliseconds(ms); }

  /// Answers all tasks of a client that has sent so many; returns the answers of each message.
  std::vector<std::size_t> messages_of(std::size_t tasks) {
    boxes_.expect("one", tasks);
    std::vector<std::size_t> messages;
    for (std::size_t i = 0; i < tasks; ++i) {
      boxes_.add("one", static_cast<int>(i), at(0));
      if (boxes_.is_due("one", at(0))) messages.push_back(take("one").size());
    }
    return messages;
  }
  std::vector<int> take(const std::string& client_id) {
    std::vector<int> answers;
    for (const int* answer : boxes_.next_message(client_id)) answers.push_back(*answer);
    boxes_.sent(client_id);
    return answers;
  }

  Outboxes<int> boxes_{{8, milliseconds(40)}};
};

TEST_F(OutboxesTest, AnswersLeaveWhenTheyAreAsManyAsTheTasksInHand) {
  EXPECT_THAT(messages_of(1), ElementsAre(1));
  EXPECT_THAT(messages_of(2), ElementsAre(1, 1));
  EXPECT_THAT(messages_of(16), ElementsAre(8, 4, 2, 1, 1));
}

TEST_F(OutboxesTest, AMessageHoldsNoMore) {
  EXPECT_THAT(messages_of(24), ElementsAre(8, 8, 4, 2, 1, 1));
}

TEST_F(OutboxesTest, TheOldestLeaveFirst) {
  boxes_.expect("one", 30);
  for (int i = 0; i < 10; ++i) boxes_.add("one", i, at(0));
  EXPECT_THAT(take("one"), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(take("one"), ElementsAre(8, 9));
  EXPECT_EQ(boxes_.waiting(), 0U);
}

TEST_F(OutboxesTest, NoneWaitsLong) {
  boxes_.expect("one", 6);
  EXPECT_EQ(boxes_.next_due(), std::nullopt);
  boxes_.add("one", 0, at(0));
  EXPECT_THAT(boxes_.due(at(39)), IsEmpty());
  EXPECT_THAT(boxes_.next_due(), Optional(at(40)));
  EXPECT_THAT(boxes_.due(at(40)), ElementsAre("one"));
}

TEST_F(OutboxesTest, EachClientHasItsOwnTime) {
  boxes_.expect("one", 6);
  boxes_.expect("two", 6);
  boxes_.add("one", 0, at(0));
  boxes_.add("two", 0, at(5));
  EXPECT_THAT(boxes_.next_due(), Optional(at(40)));
  EXPECT_THAT(boxes_.due(at(40)), ElementsAre("one"));
  take("one");
  EXPECT_THAT(boxes_.next_due(), Optional(at(45)));
}

TEST_F(OutboxesTest, AClientThatIsBlockedIsTriedAgainAndKeepsNoOtherWaiting) {
  boxes_.expect("blocked", 1);
  boxes_.expect("other", 6);
  boxes_.add("blocked", 0, at(0));
  boxes_.blocked("blocked", at(0));
  EXPECT_THAT(boxes_.due(at(39)), IsEmpty());
  boxes_.add("other", 0, at(10));
  EXPECT_THAT(boxes_.next_due(), Optional(at(40)));
  EXPECT_THAT(boxes_.due(at(40)), ElementsAre("blocked"));
  boxes_.blocked("blocked", at(40));
  EXPECT_THAT(boxes_.next_due(), Optional(at(50)));
  EXPECT_THAT(boxes_.due(at(50)), ElementsAre("other"));
  EXPECT_THAT(boxes_.with_answers(), ElementsAre("blocked", "other"));
}

TEST_F(OutboxesTest, AClientThatTakesAgainIsBlockedNoMore) {
  boxes_.expect("one", 2);
  boxes_.add("one", 0, at(0));
  boxes_.blocked("one", at(0));
  EXPECT_THAT(take("one"), ElementsAre(0)) << "its reader came";
  boxes_.add("one", 1, at(1));
  EXPECT_THAT(boxes_.due(at(1)), ElementsAre("one"));
}

TEST_F(OutboxesTest, NothingChangesUntilSoManyAnswersMoreHaveCome) {
  EXPECT_EQ(boxes_.until_due(), 1U);
  for (const std::size_t tasks : {1U, 2U, 3U, 7U, 16U, 40U}) {
    boxes_.forget("one");
    boxes_.expect("one", tasks);
    EXPECT_EQ(boxes_.until_due(), 1U) << "the first one begins to wait";
    for (std::size_t i = 0; i < tasks; ++i) {
      const bool first = boxes_.waiting() == 0;
      const std::size_t until = boxes_.until_due();
      boxes_.add("one", 0, at(0));
      const bool due = boxes_.is_due("one", at(0));
      // The first one may only start the wait.
      EXPECT_EQ(due, until == 1 && (due || !first)) << i << " of " << tasks;
      if (due) take("one");
    }
    EXPECT_EQ(boxes_.waiting(), 0U);
  }
}

TEST_F(OutboxesTest, AnAnswerThatWaitsForNobodyElseIsSeenWhateverTheOthersDo) {
  boxes_.expect("many", 40);
  boxes_.add("many", 0, at(0));
  EXPECT_EQ(boxes_.until_due(), 7U);
  boxes_.expect("few", 2);
  EXPECT_EQ(boxes_.until_due(), 1U);
}

TEST_F(OutboxesTest, WhatIsForAClientThatIsGoneIsDropped) {
  boxes_.expect("gone", 4);
  boxes_.add("gone", 0, at(0));
  boxes_.forget("gone");
  boxes_.add("gone", 1, at(0));
  EXPECT_EQ(boxes_.waiting(), 0U);
  EXPECT_EQ(boxes_.next_due(), std::nullopt);
  // A late answer to a client that has returned: the count of tasks in hand is wrong, and all
  // answers are noticed.
  boxes_.expect("gone", 1);
  boxes_.add("gone", 1, at(0));
  EXPECT_TRUE(boxes_.is_due("gone", at(0)));
  take("gone");
  EXPECT_EQ(boxes_.until_due(), 1U);
  boxes_.add("gone", 2, at(0));
  EXPECT_TRUE(boxes_.is_due("gone", at(0)));
}

TEST_F(OutboxesTest, WhatIsNotTakenIsDropped) {
  boxes_.expect("one", 9);
  boxes_.add("one", 0, at(0));
  boxes_.add("one", 1, at(10));
  boxes_.drop_older(at(10));
  EXPECT_THAT(take("one"), ElementsAre(1));
}

}  // namespace
}  // namespace topogeo::search_pool
