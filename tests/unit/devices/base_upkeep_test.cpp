#include "topogeo/devices/base_upkeep.hpp"

#include <set>

#include <gtest/gtest.h>

#include "topogeo/devices/base_start.hpp"

namespace topogeo::devices {
namespace {

class BaseUpkeepTest : public ::testing::Test {
 protected:
  std::optional<McpOrder> next(std::int64_t now_ns) {
    if (auto order = upkeep_.next_refresh(now_ns)) return order;
    return upkeep_.next(motion_, now_ns);
  }

  BaseSettings settings_;  // watchdog of 1 s, battery every 10 s
  BaseMotion motion_{McpUnits(settings_.calibration), settings_.limits};
  BaseUpkeep upkeep_{settings_};
};

TEST_F(BaseUpkeepTest, RefreshesTheWatchdogThreeTimesInItsTime) {
  upkeep_.set_up(0);
  upkeep_.refresh(0);
  EXPECT_EQ(next(0), (McpOrder{McpCommand::kWatchdog, 256}));
  EXPECT_FALSE(upkeep_.next_refresh(333'333'332));
  EXPECT_TRUE(upkeep_.next_refresh(333'333'333));
}

TEST_F(BaseUpkeepTest, RepeatsEverySettingInTurn) {
  std::multiset<McpCommand> repeated;
  const std::size_t settings = silent_orders(settings_).size();
  upkeep_.set_up(1'000'000'000'000);  // the battery is not due
  for (std::size_t i = 0; i < settings + 2; ++i) {
    const auto now_ns = static_cast<std::int64_t>(i) * 1'000'000'000;
    ASSERT_TRUE(upkeep_.next_refresh(now_ns));
    repeated.insert(upkeep_.next(motion_, now_ns)->command);
    EXPECT_FALSE(upkeep_.next(motion_, now_ns)) << "one for each refresh";
  }
  for (const McpOrder& order : silent_orders(settings_)) {
    EXPECT_EQ(repeated.count(order.command), 1U);
  }
  EXPECT_EQ(repeated.count(McpCommand::kTranslateAcceleration), 1U);
  EXPECT_EQ(repeated.count(McpCommand::kRotateAcceleration), 1U);
}

TEST_F(BaseUpkeepTest, AcknowledgesOnceAndAsksForTheBatteryNowAndThen) {
  upkeep_.refresh(1'000'000'000'000);
  upkeep_.set_up(0);
  upkeep_.acknowledge();
  EXPECT_EQ(next(0), (McpOrder{McpCommand::kAcknowledge, 0}));
  EXPECT_EQ(next(0), McpOrder{McpCommand::kBatteryVoltage});
  EXPECT_EQ(next(0), std::nullopt);
  EXPECT_EQ(upkeep_.due_ns(), 10'000'000'000);
  EXPECT_EQ(next(10'000'000'000), McpOrder{McpCommand::kBatteryVoltage});
}

}  // namespace
}  // namespace topogeo::devices
