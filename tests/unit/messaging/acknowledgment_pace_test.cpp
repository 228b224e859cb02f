#include "fast_dds/acknowledgment_pace.hpp"

#include <array>
#include <vector>

#include <gtest/gtest.h>

namespace topogeo::messaging {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPause{5};
constexpr milliseconds kPeriod{20};

class AcknowledgmentPaceTest : public ::testing::Test {
 protected:
  [[nodiscard]] bool due(std::size_t reader, milliseconds after) {
    return pace_.due(&readers_.at(reader), AcknowledgmentPace::Time(std::chrono::hours(1)) + after);
  }

  AcknowledgmentPace pace_{kPause, kPeriod};
  std::array<int, 2> readers_{};
};

TEST_F(AcknowledgmentPaceTest, OfAStreamOneMessageAPeriodIsAcknowledged) {
  std::vector<int> due_at_ms;
  for (int ms = 0; ms < 100; ms += 4) {
    if (due(0, milliseconds(ms))) due_at_ms.push_back(ms);
  }
  EXPECT_EQ(due_at_ms, (std::vector<int>{0, 20, 40, 60, 80}));
}

TEST_F(AcknowledgmentPaceTest, SingleMessagesAreAllAcknowledged) {
  for (int ms = 0; ms < 100; ms += 5) EXPECT_TRUE(due(0, milliseconds(ms))) << ms;
}

TEST_F(AcknowledgmentPaceTest, ReadersAreAskedApart) {
  EXPECT_TRUE(due(0, milliseconds(0)));
  EXPECT_TRUE(due(1, milliseconds(2)));
  EXPECT_FALSE(due(0, milliseconds(4)));
  EXPECT_FALSE(due(1, milliseconds(6)));
}

TEST_F(AcknowledgmentPaceTest, ReadersThatGetNothingAreForgotten) {
  EXPECT_TRUE(due(0, milliseconds(0)));
  EXPECT_TRUE(due(1, milliseconds(1)));
  EXPECT_EQ(pace_.readers(), 2U);
  EXPECT_TRUE(due(1, milliseconds(5000)));
  EXPECT_EQ(pace_.readers(), 1U);
}

}  // namespace
}  // namespace topogeo::messaging
