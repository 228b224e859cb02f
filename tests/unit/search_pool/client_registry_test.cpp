// Identity of a worker, and the clients that it serves.
#include "topogeo/search_pool/client_registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/search_pool/fair_queue.hpp"
#include "topogeo/search_pool/worker_name.hpp"

namespace topogeo::search_pool {
namespace {

using std::chrono::seconds;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(WorkerName, AnIdIsTheNameAndSixteenDigitsThatNobodyElseHas) {
  const std::string id = make_worker_id("pc-1");
  EXPECT_THAT(id, ::testing::StartsWith("pc-1#"));
  EXPECT_EQ(id.size(), 5U + 16U);
  EXPECT_EQ(id.find_first_not_of("0123456789abcdef", 5), std::string::npos);
  EXPECT_NE(id, make_worker_id("pc-1"));
}

TEST(WorkerName, RefusesWhatDoesNotFitOrWouldBreakAFilter) {
  EXPECT_EQ(check_name("pc-1.example"), "");
  EXPECT_EQ(check_name("gar\xC3\xA7on"), "");
  EXPECT_EQ(check_name(std::string(24, 'x')), "");
  for (const std::string& bad :
       {std::string(), std::string(25, 'x'), std::string("a#b"), std::string("a'b"),
        std::string("a\"b"), std::string("a%b"), std::string("a b"), std::string("a\nb")}) {
    EXPECT_THAT(check_name(bad), HasSubstr("expected 1 to 24 bytes")) << bad;
    EXPECT_THROW(make_worker_id(bad), std::invalid_argument) << bad;
  }
}

TEST(WorkerName, TheDefaultIsAllowed) {
  EXPECT_EQ(check_name(default_name()), "");
}

std::string drain(FairQueue<char>& queue) {
  std::string items;
  while (const auto item = queue.pop()) items.push_back(*item);
  return items;
}

TEST(FairQueue, ServesItsUsersInTurn) {
  FairQueue<char> queue;
  for (const char item : {'a', 'b', 'c', 'd'}) queue.push("long", item);
  for (const char item : {'1', '2'}) queue.push("short", item);
  queue.push("one", 'x');
  EXPECT_EQ(queue.size(), 7U);
  EXPECT_EQ(drain(queue), "a1xb2cd");
  EXPECT_TRUE(queue.empty());
}

TEST(FairQueue, WhoComesBackIsLast) {
  FairQueue<char> queue;
  queue.push("one", 'a');
  queue.push("two", '1');
  queue.push("two", '2');
  EXPECT_EQ(queue.pop(), 'a');
  queue.push("one", 'b');
  EXPECT_EQ(drain(queue), "1b2");
}

TEST(FairQueue, TakesAUserOut) {
  FairQueue<char> queue;
  for (const char item : {'a', 'b'}) queue.push("one", item);
  for (const char item : {'1', '2'}) queue.push("two", item);
  EXPECT_THAT(queue.remove("one"), ElementsAre('a', 'b'));
  EXPECT_THAT(queue.remove("one"), IsEmpty());
  EXPECT_EQ(queue.size(), 2U);
  queue.push("one", 'c');
  EXPECT_EQ(drain(queue), "1c2");
}

class ClientBookTest : public ::testing::Test {
 protected:
  static ClientRegistry::Time at(int s) { return ClientRegistry::Time{} + seconds(s); }
  static constexpr ProcessId kOne{1};
  static constexpr ProcessId kTwo{2};
  ClientRegistry book_;
};

TEST_F(ClientBookTest, KnowsTheFirstTaskOfAClientAndWhoIsActive) {
  EXPECT_TRUE(book_.task_came("a", "robot", kOne, at(0)));
  EXPECT_FALSE(book_.task_came("a", "robot", kOne, at(1)));
  EXPECT_TRUE(book_.task_came("b", "robot", kTwo, at(3)));
  EXPECT_EQ(book_.active(at(2)), 1U);
  EXPECT_EQ(book_.active(at(1)), 2U);
  EXPECT_EQ(book_.active(at(4)), 0U);
  EXPECT_EQ(book_.ever(), 2U);
}

TEST_F(ClientBookTest, AClientGoesWithTheLastReaderOfItsProcess) {
  book_.reader_came(kOne);
  book_.reader_came(kOne);
  book_.reader_came(kTwo);
  book_.task_came("a", "robot", kOne, at(0));
  book_.task_came("b", "robot", kTwo, at(0));
  book_.answered("a");
  EXPECT_THAT(book_.reader_gone(kOne), IsEmpty());
  EXPECT_TRUE(book_.is_connected(kOne));
  const auto gone = book_.reader_gone(kOne);
  ASSERT_THAT(gone, SizeIs(1));
  EXPECT_EQ(gone[0].first, "a");
  EXPECT_EQ(gone[0].second.answered, 1U);
  EXPECT_FALSE(book_.is_connected(kOne));
  EXPECT_TRUE(book_.is_connected(kTwo));
  EXPECT_THAT(book_.reader_gone(kOne), IsEmpty());
  EXPECT_TRUE(book_.task_came("a", "robot", kOne, at(1))) << "it is new when it comes back";
}

TEST_F(ClientBookTest, AClientThatNeverConnectsIsForgotten) {
  book_.reader_came(kTwo);
  book_.task_came("a", "robot", kOne, at(0));
  book_.task_came("b", "robot", kTwo, at(0));
  EXPECT_THAT(book_.take_silent(at(0)), IsEmpty());
  const auto silent = book_.take_silent(at(5));
  ASSERT_THAT(silent, SizeIs(1));
  EXPECT_EQ(silent[0].first, "a");
}

}  // namespace
}  // namespace topogeo::search_pool
