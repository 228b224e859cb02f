#include "topogeo/devices/base_link.hpp"

#include <limits>
#include <string_view>

#include <gtest/gtest.h>

namespace topogeo::devices {
namespace {

using Change = BaseLink::Change;

class BaseLinkTest : public ::testing::Test {
 protected:
  /// Writes the start sequence and passes time until the first report is due.
  void write_start() {
    while (writer_.write_queued(now_ns_)) now_ns_ = writer_.free_ns();
    (void)link_.tick(now_ns_);
  }
  /// Advances to the next due time.
  Change pass() {
    now_ns_ = link_.due_ns();
    return link_.tick(now_ns_);
  }
  Change receive(std::string_view text) {
    return link_.received({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()},
                          now_ns_);
  }
  void start() {
    link_.open(now_ns_);
    write_start();
    ASSERT_EQ(link_.reported(false, now_ns_), Change::kRunning);
  }

  BaseSettings settings_;
  BaseWriter writer_{settings_};
  BaseLink link_{settings_, writer_};
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST_F(BaseLinkTest, IsOfflineUntilAPortIsOpenedAndRunsFromTheFirstReportOn) {
  EXPECT_TRUE(link_.closed());
  EXPECT_TRUE(link_.offline());
  EXPECT_EQ(link_.reason(), "no connection to the drive unit");
  EXPECT_EQ(link_.due_ns(), std::numeric_limits<std::int64_t>::max());
  link_.open(now_ns_);
  EXPECT_FALSE(link_.offline());
  EXPECT_FALSE(link_.running());
  write_start();
  EXPECT_EQ(link_.reported(false, now_ns_), Change::kRunning);
  EXPECT_TRUE(link_.running());
  EXPECT_EQ(link_.starts(), 1U);
}

TEST_F(BaseLinkTest, AsksASilentBaseAndGoesOnWithOneThatReportsAgain) {
  start();
  EXPECT_EQ(pass(), Change::kOffline);
  EXPECT_EQ(link_.reason(), "the base stopped reporting");
  EXPECT_EQ(now_ns_ - 1'000'000'000 > 500'000'000, true);
  EXPECT_EQ(writer_.take_orders().back().bytes, (std::vector<std::uint8_t>{'\r', 'B', 'V', '\r'}));
  EXPECT_EQ(link_.reported(false, now_ns_), Change::kResumed);
  EXPECT_TRUE(link_.running());
  EXPECT_EQ(link_.starts(), 1U);
}

TEST_F(BaseLinkTest, SetsABaseUpThatWasSwitchedOnAnew) {
  start();
  EXPECT_EQ(pass(), Change::kOffline);
  EXPECT_EQ(receive("B"), Change::kNone);
  EXPECT_EQ(receive("V\r"), Change::kSetUp);  // cut anywhere
  EXPECT_EQ(link_.starts(), 2U);
  // Reports of a restarted base do not end the start sequence.
  EXPECT_EQ(link_.reported(true, now_ns_), Change::kNone);
  EXPECT_FALSE(link_.running());
}

TEST_F(BaseLinkTest, SetsABaseUpBlindlyWhenItDoesNotAnswer) {
  link_.open(now_ns_);
  write_start();
  EXPECT_EQ(pass(), Change::kOffline);
  EXPECT_EQ(link_.reason(), "the base does not answer");
  const std::int64_t asked_ns = now_ns_;
  while (pass() == Change::kNone) {
  }
  EXPECT_EQ(link_.starts(), 2U);
  EXPECT_GT(now_ns_ - asked_ns, 10'000'000'000);
}

TEST_F(BaseLinkTest, SetsABaseUpAtTheNextQuestionAfterASignOfLife) {
  link_.open(now_ns_);
  write_start();
  EXPECT_EQ(pass(), Change::kOffline);
  link_.answered();
  EXPECT_EQ(pass(), Change::kSetUp);
}

}  // namespace
}  // namespace topogeo::devices
