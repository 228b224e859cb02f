#include "topogeo/devices/pls_search.hpp"

#include <gtest/gtest.h>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

class PlsSearchTest : public ::testing::Test {
 protected:
  /// The lines that a search tries, polled or not, until it has failed.
  std::vector<LineSettings> tried_lines(bool listen_first) {
    std::vector<LineSettings> tried;
    search_.start(listen_first, now_ns_);
    do {
      tried.push_back(line_.settings());
      now_ns_ = search_.due_ns();
    } while (search_.tick(now_ns_));
    return tried;
  }

  PlsSettings settings_;
  PlsLine line_{settings_};
  PlsSearch search_{settings_, line_};
  std::int64_t now_ns_ = 0;
};

TEST_F(PlsSearchTest, TriesEachRateWithEachParityOnce) {
  line_.open();
  const auto tried = tried_lines(false);
  EXPECT_EQ(tried, (std::vector<LineSettings>{{9600, Parity::kEven},
                                              {38400, Parity::kEven},
                                              {500'000, Parity::kEven},
                                              {19200, Parity::kEven},
                                              {9600, Parity::kNone},
                                              {38400, Parity::kNone},
                                              {500'000, Parity::kNone},
                                              {19200, Parity::kNone}}));
  EXPECT_EQ(search_.failures(), 1);
  std::size_t asked = 0;
  for (const LineOrder& order : line_.take_orders()) {
    if (order.bytes == pls_mode_command(PlsMode::kOnRequest)) ++asked;
  }
  EXPECT_EQ(asked, 8U);
}

TEST_F(PlsSearchTest, TriesWhereTheSensorWasHeardFirstAndItsKindOnly) {
  line_.open();
  line_.set({38400, Parity::kNone});
  line_.heard();
  const auto tried = tried_lines(true);
  ASSERT_GE(tried.size(), 5U);
  EXPECT_EQ(tried[0], (LineSettings{38400, Parity::kNone}));
  EXPECT_EQ(tried[1], (LineSettings{38400, Parity::kNone}));
  EXPECT_EQ(tried[2], (LineSettings{9600, Parity::kNone}));
  for (const LineSettings& line : tried) EXPECT_EQ(line.parity, Parity::kNone);
  search_.start(true, now_ns_);
  EXPECT_FALSE(search_.asked()) << "it listens first";
}

TEST_F(PlsSearchTest, RestsLongerAfterEachFailureUpToAMost) {
  line_.open();
  search_.rest(1, 0);
  EXPECT_EQ(search_.rested_ns(), 250'000'000);
  search_.rest(2, 0);
  EXPECT_EQ(search_.rested_ns(), 500'000'000);
  search_.rest(1000, 0);
  EXPECT_EQ(search_.rested_ns(), 5'000'000'000);
  EXPECT_EQ(line_.settings(), (LineSettings{9600, Parity::kEven}));
}

TEST_F(PlsSearchTest, FollowsGarbageToWhereTheSensorWasHeard) {
  line_.open();
  line_.set({500'000, Parity::kEven});
  line_.heard();
  line_.set({9600, Parity::kEven});
  search_.start(false, 0);
  line_.set({19200, Parity::kEven});
  const std::vector<std::uint8_t> garbage(20, 0x55);
  line_.receive(garbage, 1);
  while (line_.decoder().next()) {
  }
  ASSERT_TRUE(search_.hears_garbage());
  search_.follow_garbage(2);
  EXPECT_EQ(line_.settings(), (LineSettings{500'000, Parity::kEven}));
  EXPECT_FALSE(search_.asked());
  EXPECT_FALSE(search_.hears_garbage()) << "it counts from the change of the line on";
}

}  // namespace
}  // namespace topogeo::devices
