#include "topogeo/service/base_confirmation.hpp"

#include <gtest/gtest.h>

namespace topogeo::service {
namespace {

msg::BaseStatus base_in(msg::BaseState state) {
  msg::BaseStatus status;
  status.state(state);
  status.stands(true);
  return status;
}

TEST(BaseConfirmation, OnlyAStopThatHoldsConfirmsAHalt) {
  for (const auto state : {msg::kBaseHalted, msg::kBaseEmergencyStop}) {
    EXPECT_TRUE(confirms(base_in(state), msg::kBaseHalt)) << state;
    EXPECT_FALSE(confirms(base_in(state), msg::kBaseReset)) << state;
  }
  // All these refuse motion commands, too.
  for (const auto state : {msg::kBaseOffline, msg::kBaseStarting, msg::kBaseWatchdogExpired,
                           msg::kBaseBumped, msg::kBaseJoystick, msg::kBaseMotorsOff}) {
    EXPECT_FALSE(confirms(base_in(state), msg::kBaseHalt)) << state;
    EXPECT_TRUE(confirms(base_in(state), msg::kBaseReset)) << state;
  }
  EXPECT_TRUE(confirms(base_in(msg::kBaseMoving), msg::kBaseSetLimits));
}

TEST(BaseConfirmation, ABaseThatStillMovesConfirmsNoHalt) {
  msg::BaseStatus brakes = base_in(msg::kBaseHalted);
  brakes.stands(false);
  EXPECT_FALSE(confirms(brakes, msg::kBaseHalt));
  EXPECT_FALSE(confirms(brakes, msg::kBaseReset)) << "it is held all the same";
}

TEST(BaseConfirmation, AResetIsRefusedIfTheBaseWasStoppedSince) {
  msg::BaseCommand reset;
  reset.kind(msg::kBaseReset);
  reset.stop_count(7);
  msg::BaseStatus status = base_in(msg::kBaseHalted);
  status.stop_count(7);
  EXPECT_FALSE(refuses(status, reset)) << "the gateway may still release it";
  status.stop_count(8);
  EXPECT_TRUE(refuses(status, reset));
  status.state(msg::kBaseReady);
  EXPECT_FALSE(refuses(status, reset));
  reset.kind(msg::kBaseHalt);
  status.state(msg::kBaseHalted);
  EXPECT_FALSE(refuses(status, reset));
}

}  // namespace
}  // namespace topogeo::service
