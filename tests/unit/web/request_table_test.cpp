// Requests without a reply, on a simulated clock.
#include "orders/request_table.hpp"

#include <vector>

#include <gmock/gmock.h>

namespace topogeo::web {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

class RequestTableTest : public testing::Test {
 protected:
  void begin(std::function<bool()> heard = {}) {
    table_.begin([this](const Answer& answer) { answers_.push_back(answer); },
                 [this](std::uint64_t id) { sent_.push_back(id); }, std::move(heard), now_s_);
  }
  /// Eight calls a second, about as many as in the service: their times are exact in binary.
  void pass(double duration_s, const std::string& busy = {}) {
    for (int i = 0; i < static_cast<int>(8.0 * duration_s); ++i) {
      now_s_ += 0.125;
      table_.tick(now_s_, busy);
    }
  }

  double now_s_ = 1000.0;
  RequestTable table_{"nobody answers", 5.0, now_s_, 70};
  std::vector<std::uint64_t> sent_;
  std::vector<Answer> answers_;
};

TEST_F(RequestTableTest, AReplyGoesToWhoeverHasAskedAndOnce) {
  begin();
  begin();
  EXPECT_THAT(sent_, ElementsAre(71, 72)) << "each under a number of its own";
  const std::optional<Respond> respond = table_.take(72);
  ASSERT_TRUE(respond);
  (*respond)(Answer{});
  EXPECT_THAT(answers_, SizeIs(1));
  EXPECT_FALSE(table_.take(72));
  EXPECT_FALSE(table_.take(5)) << "of another page";
  pass(60.0);
  EXPECT_THAT(answers_, SizeIs(2)) << "only the other one is given up";
}

TEST_F(RequestTableTest, IsSentAgainEachSecondUntilTheReply) {
  begin();
  pass(1.0);
  EXPECT_THAT(sent_, ElementsAre(71));
  pass(2.5);
  EXPECT_THAT(sent_, ElementsAre(71, 71, 71, 71));
  ASSERT_TRUE(table_.take(71));
  pass(10.0);
  EXPECT_THAT(sent_, SizeIs(4));
  EXPECT_THAT(answers_, IsEmpty());
}

TEST_F(RequestTableTest, IsGivenUpAfterThePatience) {
  begin();
  pass(5.0);
  EXPECT_THAT(answers_, IsEmpty());
  pass(0.125);
  ASSERT_THAT(answers_, SizeIs(1));
  EXPECT_EQ(answers_[0].status, 503U);
  EXPECT_THAT(answers_[0].body, HasSubstr("nobody answers\""));
  EXPECT_FALSE(table_.take(71)) << "a reply that comes later has no one to go to";
}

TEST_F(RequestTableTest, ABusyMachineGetsSixTimesAsLongAndIsNamed) {
  begin();
  pass(29.5, "the CPU is short");
  EXPECT_THAT(answers_, IsEmpty());
  pass(1.0, "the CPU is short");
  ASSERT_THAT(answers_, SizeIs(1));
  EXPECT_THAT(answers_[0].body,
              HasSubstr("nobody answers; this machine is too busy: the CPU is short"));
}

TEST_F(RequestTableTest, AShortageThatEndsLeavesTheRestOfThePatience) {
  begin();
  pass(24.0, "the CPU is short");  // 4 s of the patience
  pass(0.75);
  EXPECT_THAT(answers_, IsEmpty());
  pass(0.5);
  ASSERT_THAT(answers_, SizeIs(1));
  EXPECT_THAT(answers_[0].body, HasSubstr("the CPU is short"));
  begin();
  pass(5.25);
  ASSERT_THAT(answers_, SizeIs(2));
  EXPECT_THAT(answers_[1].body, Not(HasSubstr("busy"))) << "a later request met no shortage";
}

TEST_F(RequestTableTest, ATimeInWhichTheProcessStoodStillCountsAlmostNothing) {
  begin();
  now_s_ += 3600.0;
  table_.tick(now_s_, "");
  pass(4.25);
  EXPECT_THAT(answers_, IsEmpty()) << "half a second of the hour counts";
  pass(0.5);
  EXPECT_THAT(answers_, SizeIs(1));
}

TEST_F(RequestTableTest, AServiceThatIsHeardHasAMinute) {
  bool there = true;
  begin([&] { return there; });
  pass(59.5);
  EXPECT_THAT(answers_, IsEmpty());
  pass(1.0);
  EXPECT_THAT(answers_, SizeIs(1));
  begin([&] { return there; });
  pass(10.0);
  EXPECT_THAT(answers_, SizeIs(1));
  there = false;
  pass(0.125);
  EXPECT_THAT(answers_, SizeIs(2)) << "it has left, and the patience is long over";
}

}  // namespace
}  // namespace topogeo::web
