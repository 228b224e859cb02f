// The emulated base by itself: its output on a terminal, and the motion of its wheels.
#include "topogeo/simulation/mcp_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/devices/mcp_binary.hpp"

namespace topogeo::simulation {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1'000'000'000;

/// A terminal with the base's own line settings; the wheels are free.
class Terminal {
 public:
  explicit Terminal(McpEmulatorSettings settings = {}) : line(settings.line), base(settings) {
    pass(settings.start_up_ns + kMs);
  }

  void pass(std::int64_t duration_ns) {
    for (const std::int64_t end_ns = now_ns + duration_ns; now_ns < end_ns;) {
      const std::int64_t step_ns = std::min(5 * kMs, end_ns - now_ns);
      const Velocity velocity = base.commanded_velocity();
      const double dt_s = 1e-9 * static_cast<double>(step_ns);
      base.moved(velocity.linear_m_per_s * dt_s, velocity.angular_rad_per_s * dt_s, dt_s);
      now_ns += step_ns;
      base.tick(now_ns);
      fastest_mps = std::max(fastest_mps, std::abs(velocity.linear_m_per_s));
    }
  }
  std::string type(std::string_view text, std::int64_t wait_ns = 200 * kMs) {
    base.receive(std::vector<std::uint8_t>(text.begin(), text.end()), line, now_ns);
    return hear(wait_ns);
  }
  std::string hear(std::int64_t wait_ns) {
    pass(wait_ns);
    const auto bytes = base.take_output(line, now_ns);
    return {bytes.begin(), bytes.end()};
  }

  devices::LineSettings line;
  McpEmulator base;
  std::int64_t now_ns = 0;
  double fastest_mps = 0.0;
};

TEST(McpEmulator, EchoesUntilItIsToldNotTo) {
  Terminal terminal;
  EXPECT_EQ(terminal.type("BV\r"), "BV\r\nBV 1e2\r\n");
  EXPECT_EQ(terminal.type("HD\r"), "HD\r\n");
  EXPECT_EQ(terminal.type("BV\r"), "BV 1e2\r\n");
  EXPECT_EQ(terminal.type("RW\r"), "RW 80000000\r\n");
  EXPECT_EQ(terminal.type("nonsense\rTV\rTV fffff\rBV 1\r"), "");
}

TEST(McpEmulator, HearsNothingBeforeItIsUpNorAtAnotherRate) {
  McpEmulator base({});
  const std::vector<std::uint8_t> question{'B', 'V', '\r'};
  base.receive(question, {}, kSecond);
  EXPECT_TRUE(base.take_output({}, 2 * kSecond).empty());
  base.receive(question, {38400, devices::Parity::kNone}, 3 * kSecond);
  EXPECT_TRUE(base.take_output({}, 4 * kSecond).empty());
  base.receive(question, {}, 5 * kSecond);
  const auto garbled = base.take_output({38400, devices::Parity::kNone}, 6 * kSecond);
  EXPECT_FALSE(garbled.empty());
  EXPECT_EQ(std::search(garbled.begin(), garbled.end(), question.begin(), question.end()),
            garbled.end());
}

TEST(McpEmulator, ReportsInTheFormAndPeriodThatItWasTold) {
  Terminal terminal;
  (void)terminal.type("HD\rSD a0a7a\r");
  const std::string first = terminal.type("SP 40\r", 400 * kMs);
  EXPECT_EQ(first.substr(0, 24), "%PSR\r\nCLK 00000273\r\nBBS ");
  EXPECT_NE(first.find("\r\nBPX 8000\r\nBPY 8000\r\nTPH 0000\r\nTVE 0000\r\n"), std::string::npos);
  const std::string later = terminal.hear(10 * kSecond);
  std::size_t reports = 0;
  for (std::size_t at = later.find("%PSR"); at != std::string::npos;
       at = later.find("%PSR", at + 1)) {
    ++reports;
  }
  EXPECT_EQ(reports, 40U);  // a quarter of a second
  (void)terminal.type("SP 0\r", kSecond);
  EXPECT_EQ(terminal.hear(kSecond), "");
}

TEST(McpEmulator, SendsNoFasterThanItsLine) {
  Terminal terminal;
  (void)terminal.type("HD\rSD ffffffff\rSP 1\r", 0);
  EXPECT_NEAR(static_cast<double>(terminal.hear(10 * kSecond).size()), 9600.0, 10.0);
}

TEST(McpEmulator, GoesDistancesBothWaysAndToPlaces) {
  Terminal terminal;
  (void)terminal.type("HD\rTV 2000\rTA 2000\rRV 80\rRA 80\r");
  const devices::McpUnits units{devices::McpCalibration{}};
  const auto ahead_m = [&] { return terminal.base.T_start_robot().x_m; };
  (void)terminal.type("T> 6dd8\r", 10 * kSecond);  // 28120 counts
  EXPECT_NEAR(ahead_m(), 1.0, 0.002);
  EXPECT_NEAR(terminal.fastest_mps, units.metres(0x2000), 1e-6);
  (void)terminal.type("T< 36ec\r", 10 * kSecond);
  EXPECT_NEAR(ahead_m(), 0.5, 0.002);
  (void)terminal.type("TP 0\r", 10 * kSecond);
  EXPECT_NEAR(ahead_m(), 0.0, 0.002);
  (void)terminal.type("R> 100\r", 10 * kSecond);  // clockwise
  EXPECT_NEAR(terminal.base.T_start_robot().theta_rad, -std::numbers::pi / 2, 0.01);
  (void)terminal.type("RP 80000000\r", 10 * kSecond);
  EXPECT_NEAR(terminal.base.T_start_robot().theta_rad, 0.0, 0.01);
}

TEST(McpEmulator, AcceleratesAndHaltsAsTold) {
  Terminal terminal;
  const devices::McpUnits units{devices::McpCalibration{}};
  const auto speed_mps = [&] { return terminal.base.commanded_velocity().linear_m_per_s; };
  (void)terminal.type("TV 4000\rTA 2000\rT+\r", kSecond);
  EXPECT_NEAR(speed_mps(), units.metres(0x2000), 0.002);
  terminal.pass(2 * kSecond);
  EXPECT_NEAR(speed_mps(), units.metres(0x4000), 1e-9);
  (void)terminal.type("TV 1000\r", 3 * kSecond);  // acts on the motion in progress
  EXPECT_NEAR(speed_mps(), units.metres(0x1000), 1e-9);
  (void)terminal.type("TH\r", 300 * kMs);
  EXPECT_GT(speed_mps(), 0.0);
  terminal.pass(kSecond);
  EXPECT_EQ(speed_mps(), 0.0);
}

TEST(McpEmulator, StopsByItselfWhenNobodyFeedsItsWatchdog) {
  for (const bool limps : {false, true}) {
    Terminal terminal({.watchdog_limps = limps});
    (void)terminal.type("HD\rWD 100\rT+\r", 900 * kMs);
    EXPECT_NE(terminal.base.commanded_velocity().linear_m_per_s, 0.0);
    EXPECT_EQ(terminal.hear(2 * kSecond), "%WDT motors stopped\r\n");
    EXPECT_EQ(terminal.base.commanded_velocity().linear_m_per_s, 0.0);
  }
}

TEST(McpEmulator, SpeaksTheBinaryDialectAndFindsPacketsAgain) {
  Terminal terminal;
  (void)terminal.type("\rBE FFFF\rDM\r");
  ASSERT_TRUE(terminal.base.binary());
  const auto say = [&](std::vector<std::uint8_t> bytes) {
    return terminal.type({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  };
  const std::string lost("\x02\x02\x01\x00\x00\x03\x03", 7);
  const std::string battery("\x02\x02\x03\x00\x60\x01\xE2\x83\x03\x03", 10);
  const std::vector<std::uint8_t> question{0x60, 0, 0, 0, 0, 0x60};
  EXPECT_EQ(say(question), "");  // not in step yet
  EXPECT_EQ(say(std::vector<std::uint8_t>(7)), "");
  EXPECT_EQ(say(question), battery);
  EXPECT_EQ(say({0x60, 0, 0, 0, 0, 0x61}), lost);
  EXPECT_EQ(say(question), "");
  for (std::size_t strays = 0; strays < 6; ++strays) {
    (void)say(std::vector<std::uint8_t>(strays, 0x55));
    (void)say(std::vector<std::uint8_t>(devices::kMcpSyncZeros));
    EXPECT_EQ(say(question), battery) << strays;
  }
}

TEST(McpEmulator, KnowsNothingOfBeforeItsPowerWasOff) {
  Terminal terminal;
  const std::string told = "HD\rSD a0a7a\rSP 40\rTV 2000\rTA 2000\rRV 80\rT+\rR+\r";
  (void)terminal.type(told, 3 * kSecond);
  EXPECT_NE(terminal.base.commanded_velocity().linear_m_per_s, 0.0);
  EXPECT_EQ(terminal.hear(kSecond).find("%PSR\r\nCLK 000000"), std::string::npos);

  terminal.base.switch_off(terminal.now_ns);
  EXPECT_EQ(terminal.base.commanded_velocity().linear_m_per_s, 0.0);
  EXPECT_EQ(terminal.base.commanded_velocity().angular_rad_per_s, 0.0);
  EXPECT_EQ(terminal.type(told, 10 * kSecond), "");
  terminal.base.moved(0.5, 0.0, 1.0);  // pushed away
  EXPECT_NE(terminal.base.T_start_robot().x_m, 0.0);

  terminal.base.switch_on(terminal.now_ns);
  EXPECT_EQ(terminal.type("BV\r", kSecond), "");
  terminal.pass(2 * kSecond);
  EXPECT_EQ(terminal.type("BV\r"), "BV\r\nBV 1e2\r\n");  // echoes again, reports no more
  EXPECT_EQ(terminal.type("HD\rTW\rRW\r"), "HD\r\nTW 0\r\nRW 80000000\r\n");
  const std::string report = terminal.type("SD a0a7a\rSP 40\r", 400 * kMs);
  EXPECT_EQ(report.substr(0, 16), "%PSR\r\nCLK 000003");  // three seconds of 256 ticks and a little
  EXPECT_NE(report.find("BPX 8000\r\nBPY 8000\r\nTPH 0000\r\nTVE 0000\r\n"), std::string::npos);
}

TEST(McpEmulator, CutsReportsOfAnyLength) {
  for (const std::string mask : {"0", "1", "2", "a0a7a", "ffffffff"}) {
    Terminal terminal;
    (void)terminal.type("HD\rSD " + mask + "\rSP 100\r");
    const std::size_t whole = terminal.hear(50 * kSecond).size();
    terminal.base.line_faults().truncate(50);
    const std::size_t cut = terminal.hear(50 * kSecond).size();
    EXPECT_GT(cut, 0U) << mask;
    EXPECT_LT(cut, whole) << mask;
  }
}

TEST(McpEmulator, StopsWhenItBumpsUnlessToldOtherwise) {
  for (const bool stops : {true, false}) {
    Terminal terminal;
    (void)terminal.type(stops ? "HD\rBE 0\rT+\r" : "HD\rBE FFFF\rT+\r", kSecond);
    terminal.base.press_bumpers(0x0008, terminal.now_ns);
    EXPECT_EQ(terminal.hear(kSecond), "%BS fff7\r\n");
    EXPECT_EQ(terminal.base.commanded_velocity().linear_m_per_s == 0.0, stops);
  }
}

}  // namespace
}  // namespace topogeo::simulation
