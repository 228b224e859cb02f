#include "topogeo/devices/pls_setup.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "topogeo/devices/pls_messages.hpp"

namespace topogeo::devices {
namespace {

using SetupResult = PlsSetup::Result;

class PlsSetupTest : public ::testing::Test {
 protected:
  void SetUp() override {
    line_.open();
    line_.heard();
    (void)line_.take_orders();
  }
  /// The last written command.
  std::vector<std::uint8_t> written() {
    auto orders = line_.take_orders();
    return orders.empty() ? std::vector<std::uint8_t>{} : orders.back().bytes;
  }
  SetupResult reply(PlsModeReply reply = PlsModeReply::kDone) {
    exchange_.replied(reply);
    return setup_.go_on(0);
  }
  /// Lets all attempts time out.
  SetupResult stay_silent() {
    while (exchange_.open()) exchange_.tick(exchange_.due_ns());
    return setup_.go_on(0);
  }

  PlsSettings settings_;  // 500,000 baud desired, found at 9600
  PlsLine line_{settings_};
  SickExchange exchange_;
  PlsSetup setup_{settings_, line_, exchange_};
};

TEST_F(PlsSetupTest, StopsInstallsChangesTheRateProvesItAsksAndStarts) {
  setup_.start(0);
  EXPECT_EQ(written(), pls_mode_command(PlsMode::kOnRequest));
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(written(), pls_mode_command(PlsMode::kInstallation, "SICK_PLS"));
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(written(), pls_baud_command(500'000).value());
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(line_.settings().baud, 500'000U);
  EXPECT_EQ(setup_.reason(), "waits after the change to 500000 baud");
  EXPECT_EQ(setup_.due_ns(), settings_.settle_ns);
  EXPECT_TRUE(written().empty());
  setup_.tick(settings_.settle_ns);
  EXPECT_EQ(written(), pls_mode_command(PlsMode::kOnRequest));
  EXPECT_EQ(setup_.due_ns(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(line_.known()->baud, 500'000U);
  EXPECT_EQ(written(), sick_command(pls_command::kRequestStatus));
  EXPECT_EQ(stay_silent(), SetupResult::kGoesOn) << "not every sensor has a status";
  EXPECT_EQ(written(), sick_command(pls_command::kRequestErrors));
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(written(), pls_mode_command(PlsMode::kStream));
  EXPECT_EQ(reply(), SetupResult::kDone);
  EXPECT_EQ(setup_.fallback(), "");
  EXPECT_EQ(setup_.failures(), 0);
}

TEST_F(PlsSetupTest, RunsAtTheRateThatItHasWhenThePasswordIsRefused) {
  setup_.start(0);
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(reply(PlsModeReply::kRefused), SetupResult::kGoesOn);
  EXPECT_EQ(written(), sick_command(pls_command::kRequestStatus));
  EXPECT_EQ(setup_.fallback(), "runs at 9600 baud: the password is refused");
}

// The request for installation mode was lost, and a late answer to another one counted for it.
TEST_F(PlsSetupTest, AsksForInstallationModeAgainWhenTheRateIsRefused) {
  setup_.start_stopped(0);
  EXPECT_EQ(reply(), SetupResult::kGoesOn);  // installation mode
  EXPECT_EQ(reply(PlsModeReply::kRefused), SetupResult::kGoesOn);
  EXPECT_EQ(written(), pls_mode_command(PlsMode::kInstallation, "SICK_PLS"));
  EXPECT_EQ(reply(), SetupResult::kGoesOn);
  EXPECT_EQ(written(), pls_baud_command(500'000).value());
  EXPECT_EQ(reply(PlsModeReply::kRefused), SetupResult::kGoesOn);
  EXPECT_EQ(written(), sick_command(pls_command::kRequestStatus));
  EXPECT_EQ(setup_.fallback(), "runs at 9600 baud: the sensor refuses 500000 baud");
}

TEST_F(PlsSetupTest, GivesTheRateUpWhenTheSensorDoesNotFollowTwice) {
  for (int i = 0; i < 2; ++i) {
    line_.set({9600, Parity::kEven});
    setup_.start_stopped(0);
    EXPECT_EQ(reply(), SetupResult::kGoesOn);  // installation mode
    EXPECT_EQ(reply(), SetupResult::kGoesOn);  // the rate
    setup_.tick(settings_.settle_ns);
    EXPECT_EQ(stay_silent(), SetupResult::kNotFollowed);
  }
  line_.set({9600, Parity::kEven});
  setup_.start_stopped(0);
  EXPECT_EQ(setup_.fallback(), "runs at 9600 baud: the sensor does not switch to 500000 baud");
  setup_.retry_rate();
  EXPECT_EQ(setup_.fallback(), "");
}

TEST_F(PlsSetupTest, AnLmsChangesItsRateWithoutAPassword) {
  line_.set({9600, Parity::kNone});
  setup_.start_stopped(0);
  EXPECT_EQ(written(), pls_baud_command(500'000).value());
}

TEST_F(PlsSetupTest, CountsItsFailuresUntilScansCome) {
  setup_.start(0);
  EXPECT_EQ(stay_silent(), SetupResult::kFailed);
  EXPECT_EQ(setup_.reason(), "the sensor does not stop its stream");
  EXPECT_EQ(setup_.failures(), 1);
  setup_.reset();
  EXPECT_EQ(setup_.failures(), 0);
}

}  // namespace
}  // namespace topogeo::devices
