#include "topogeo/devices/sick_exchange.hpp"

#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/line_time.hpp"
#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

using Result = SickExchange::Result;

constexpr LineSettings kLine{9600, Parity::kEven};
constexpr SickExchange::Limits kLimits{100, 1000, 30, 2, true};

/// Requests the status at the time 0.
class SickExchangeTest : public ::testing::Test {
 protected:
  SickExchangeTest() {
    exchange.start(command, kLimits, kLine, 0);
    EXPECT_EQ(exchange.take_command(), command);
    EXPECT_FALSE(exchange.take_command()) << "only once";
  }

  const std::vector<std::uint8_t> command = sick_command(pls_command::kRequestStatus);
  /// Time when the command has been sent.
  const std::int64_t left_ns = line_time_ns(command.size(), kLine);
  SickExchange exchange;
};

TEST_F(SickExchangeTest, EndsWithTheReply) {
  EXPECT_EQ(exchange.result(), Result::kOpen);
  EXPECT_EQ(exchange.code(), pls_reply::kStatus);
  EXPECT_EQ(exchange.due_ns(), left_ns + 100);
  exchange.acknowledged(left_ns + 40);
  EXPECT_EQ(exchange.due_ns(), left_ns + 1040);
  exchange.replied(PlsModeReply::kRefused);
  EXPECT_EQ(exchange.result(), Result::kReplied);
  EXPECT_EQ(exchange.mode_reply(), PlsModeReply::kRefused);
  EXPECT_EQ(exchange.due_ns(), std::numeric_limits<std::int64_t>::max());
}

TEST_F(SickExchangeTest, DoesNotNeedTheAck) {
  exchange.replied(std::nullopt);
  EXPECT_EQ(exchange.result(), Result::kReplied);
  EXPECT_EQ(exchange.mode_reply(), PlsModeReply::kDone);
}

TEST_F(SickExchangeTest, RepeatsAfterSilenceAndThenGivesUp) {
  exchange.tick(left_ns + 99);
  EXPECT_EQ(exchange.timeouts(), 0U);
  exchange.tick(left_ns + 100);
  EXPECT_EQ(exchange.timeouts(), 1U);
  EXPECT_FALSE(exchange.take_command()) << "a rest first";
  exchange.tick(left_ns + 130);
  EXPECT_EQ(exchange.take_command(), command);
  EXPECT_EQ(exchange.repeats(), 1U);
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.result(), Result::kSilent);
  EXPECT_FALSE(exchange.take_command());
}

TEST_F(SickExchangeTest, TellsAMissingReplyFromSilence) {
  exchange.acknowledged(left_ns);
  exchange.tick(exchange.due_ns());
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.take_command(), command);
  exchange.acknowledged(exchange.due_ns() - 1);
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.result(), Result::kNoReply);
}

TEST_F(SickExchangeTest, RepeatsWhatIsRefused) {
  exchange.refused(left_ns + 10);
  EXPECT_EQ(exchange.due_ns(), left_ns + 40);
  exchange.refused(left_ns + 11);
  EXPECT_EQ(exchange.refusals(), 1U) << "one answer to one command";
  exchange.tick(left_ns + 40);
  EXPECT_EQ(exchange.take_command(), command);
  exchange.refused(left_ns + 1000);
  EXPECT_EQ(exchange.result(), Result::kRefused);
}

TEST_F(SickExchangeTest, MayRepeatOnlyWhatIsRefused) {
  SickExchange::Limits limits = kLimits;
  limits.repeat_unanswered = false;
  exchange.start(command, limits, kLine, 0);
  EXPECT_EQ(exchange.take_command(), command);
  exchange.refused(left_ns + 10);
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.take_command(), command);
  exchange.start(command, limits, kLine, 0);
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.result(), Result::kSilent);
}

TEST_F(SickExchangeTest, WaitsForOtherRepliesAfterTheReplyToARepeatedCommand) {
  exchange.tick(exchange.due_ns());
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.take_command(), command);
  exchange.replied(std::nullopt);
  const std::int64_t replied_ns = left_ns + 200;
  const std::vector<std::uint8_t> next = sick_command(pls_command::kRequestErrors);
  exchange.start(next, kLimits, kLine, replied_ns);
  EXPECT_EQ(exchange.due_ns(), 2 * replied_ns + 30);
  exchange.acknowledged(replied_ns + 1);
  exchange.refused(replied_ns + 1);
  exchange.replied(std::nullopt);
  EXPECT_EQ(exchange.result(), Result::kOpen) << "these answer the repeated command";
  EXPECT_EQ(exchange.due_ns(), 2 * replied_ns + 30);
  EXPECT_FALSE(exchange.take_command());
  exchange.tick(exchange.due_ns());
  EXPECT_EQ(exchange.take_command(), next);
  EXPECT_EQ(exchange.repeats(), 1U) << "that of the first command";
  exchange.replied(std::nullopt);
  EXPECT_EQ(exchange.result(), Result::kReplied);
  exchange.start(command, kLimits, kLine, 10 * replied_ns);
  EXPECT_EQ(exchange.take_command(), command) << "the last one was not repeated";
}

TEST_F(SickExchangeTest, IgnoresWhatComesAfterTheEnd) {
  exchange.stop();
  exchange.acknowledged(1);
  exchange.refused(1);
  exchange.replied(PlsModeReply::kDone);
  exchange.tick(std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(exchange.result(), Result::kNone);
  EXPECT_EQ(exchange.timeouts() + exchange.refusals(), 0U);
}

}  // namespace
}  // namespace topogeo::devices
