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

  static BaseSettings settings() {
    BaseSettings settings;  // battery every 10 s
    settings.watchdog_s = 1.0;
    return settings;
  }

  BaseSettings settings_ = settings();
  BaseMotion motion_{McpUnits(settings_.calibration), settings_.limits};
  BaseUpkeep upkeep_{settings_};
};

TEST_F(BaseUpkeepTest, RefreshesTheWatchdogFiveTimesInItsTime) {
  upkeep_.set_up(0);
  upkeep_.refresh(0);
  EXPECT_EQ(next(0), (McpOrder{McpCommand::kWatchdog, 256}));
  EXPECT_FALSE(upkeep_.next_refresh(199'999'999));
  EXPECT_TRUE(upkeep_.next_refresh(200'000'000));
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

TEST_F(BaseUpkeepTest, LeavesTheLineToMotionWhereTheWatchdogIsShort) {
  BaseSettings settings;
  settings.watchdog_s = 0.1;
  BaseUpkeep upkeep(settings);
  upkeep.set_up(1'000'000'000'000);
  unsigned repeated = 0;
  for (std::int64_t now_ns = 0; now_ns < 3'000'000'000; now_ns += 20'000'000) {
    EXPECT_TRUE(upkeep.next_refresh(now_ns));
    if (upkeep.next(motion_, now_ns)) ++repeated;
  }
  EXPECT_EQ(repeated, 10U);
}

TEST(BaseWatchdog, IsNeverLongerThanTheGuardsCount) {
  BaseSettings settings;
  settings.watchdog_s = 0.3;  // 76.8 ticks
  EXPECT_EQ(watchdog_order(settings), (McpOrder{McpCommand::kWatchdog, 76}));
  settings.watchdog_s = 0.001;
  EXPECT_EQ(watchdog_order(settings).argument, 1U) << "0 would switch it off";
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
