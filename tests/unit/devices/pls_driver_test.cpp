#include "topogeo/devices/pls_driver.hpp"

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/simulation/laser_emulator.hpp"

#include "pls_on_line.hpp"
#include "sick_streams.hpp"

namespace topogeo::devices {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

simulation::PlsEmulatorSettings lms() {
  simulation::PlsEmulatorSettings settings;
  settings.power_on = {9600, Parity::kNone};
  settings.password = "SICK_LMS";
  settings.power_on_text = "LMS200;emulated";
  return settings;
}

/// A device that gets to run only now and then, as on a busy machine: it takes all bytes that have
/// come since then at once.
class LateDevice final : public simulation::SerialDevice {
 public:
  LateDevice(SerialDevice& device, std::int64_t period_ns)
      : device_(device), period_ns_(period_ns) {}

  void receive(std::span<const std::uint8_t> bytes, const LineSettings& host,
               std::int64_t) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    host_ = host;
  }
  void tick(std::int64_t now_ns) override {
    if (now_ns < runs_at_ns_) return;
    runs_at_ns_ = now_ns + period_ns_;
    if (!bytes_.empty()) device_.receive(std::exchange(bytes_, {}), host_, now_ns);
    device_.tick(now_ns);
  }
  [[nodiscard]] std::int64_t due_ns() const override { return runs_at_ns_; }
  std::vector<std::uint8_t> take_output(const LineSettings& host, std::int64_t now_ns) override {
    return device_.take_output(host, now_ns);
  }

 private:
  SerialDevice& device_;
  std::int64_t period_ns_;
  std::int64_t runs_at_ns_ = 0;
  std::vector<std::uint8_t> bytes_;
  LineSettings host_;
};

/// Desired rate, rate of the sensor when the port opens, and whether it is streaming.
using StartUp = std::tuple<std::uint32_t, std::uint32_t, bool>;
class PlsStartUp : public ::testing::TestWithParam<StartUp> {};

TEST_P(PlsStartUp, FindsTheSensorAndChangesItsRate) {
  const auto [wanted, found, streaming] = GetParam();
  PlsSettings settings;
  settings.baud = wanted;
  PlsOnLine pls(settings);
  pls.emulator.set_up(found, streaming, 0);
  pls.run_for(100 * kMillisecond_ns);
  EXPECT_EQ(pls.driver.status().state, PlsState::kOffline);
  pls.line.plug_in();
  EXPECT_EQ(pls.driver.status().state, PlsState::kDetecting);
  ASSERT_TRUE(pls.run_for_scans(1, 10 * kSecond_ns)) << pls.driver.status().reason;
  const PlsStatus status = pls.driver.status();
  EXPECT_EQ(status.state, PlsState::kRunning);
  EXPECT_EQ(status.reason, "");
  EXPECT_EQ(status.line, (LineSettings{wanted, Parity::kEven}));
  EXPECT_EQ(pls.emulator.line(), status.line);
  EXPECT_EQ(status.software, "P 01.23");
  EXPECT_FALSE(status.lms);
  pls.run_for(5 * kSecond_ns);
  EXPECT_EQ(pls.wrong_scans, 0U);
  EXPECT_EQ(pls.driver.status().counters.silences, 0U);
}

INSTANTIATE_TEST_SUITE_P(Rates, PlsStartUp,
                         ::testing::Combine(::testing::Values(9600U, 38400U, 500'000U),
                                            ::testing::Values(9600U, 19200U, 38400U, 500'000U),
                                            ::testing::Bool()));

TEST(PlsDriver, HearsASensorAtOnceThatGoesOnSendingWhereItWasRemembered) {
  PlsOnLine pls;
  pls.emulator.set_up(500'000, true, 0);
  pls.driver.resume({500'000, Parity::kEven});
  pls.line.plug_in();
  // The rest of an ongoing scan, and a whole one.
  ASSERT_TRUE(pls.run_for_scans(1, 100 * kMillisecond_ns)) << pls.driver.status().reason;
  EXPECT_EQ(pls.driver.status().state, PlsState::kRunning);
  pls.run_for(kSecond_ns);
  EXPECT_EQ(pls.wrong_scans, 0U);
  EXPECT_EQ(pls.driver.status().counters.unsolicited, 0U);
}

/// Remembered line settings, actual rate of the sensor, and whether it is streaming.
using Remembered = std::tuple<LineSettings, std::uint32_t, bool>;
class PlsElsewhere : public ::testing::TestWithParam<Remembered> {};

TEST_P(PlsElsewhere, IsFoundAllTheSame) {
  const auto [remembered, baud, streaming] = GetParam();
  PlsOnLine pls;
  pls.emulator.set_up(baud, streaming, 0);
  pls.driver.resume(remembered);
  pls.line.plug_in();
  ASSERT_TRUE(pls.run_for_scans(3, 12 * kSecond_ns)) << pls.driver.status().reason;
  EXPECT_EQ(pls.driver.status().line, (LineSettings{500'000, Parity::kEven}));
  EXPECT_EQ(pls.driver.status().software, "P 01.23") << "it was set up anew";
  EXPECT_EQ(pls.wrong_scans, 0U);
}

INSTANTIATE_TEST_SUITE_P(Lines, PlsElsewhere,
                         ::testing::Combine(::testing::Values(LineSettings{500'000, Parity::kEven},
                                                              LineSettings{38400, Parity::kEven},
                                                              LineSettings{9600, Parity::kNone}),
                                            ::testing::Values(9600U, 19200U), ::testing::Bool()));

TEST(PlsDriver, SetsUpASensorThatWasSwitchedOffMeanwhile) {
  PlsOnLine pls;
  pls.driver.resume({500'000, Parity::kEven});
  pls.line.plug_in();
  ASSERT_TRUE(pls.run_for_scans(1, 2 * kSecond_ns)) << pls.driver.status().reason;
  EXPECT_EQ(pls.driver.status().line.baud, 500'000U);
}

/// Line rate, and duration of a scan of 732 bytes of 11 bits.
class PlsRate : public ::testing::TestWithParam<std::uint32_t> {};

TEST_P(PlsRate, IsThatOfTheLineOrOfTheMirror) {
  PlsSettings settings;
  settings.baud = GetParam();
  PlsOnLine pls(settings);
  pls.start();
  const std::size_t before = pls.scans.size();
  const double seconds = 100.0;
  pls.run_for(static_cast<std::int64_t>(seconds) * kSecond_ns);
  const double rate_hz = static_cast<double>(pls.scans.size() - before) / seconds;
  const double line_hz = static_cast<double>(GetParam()) / (732.0 * 11.0);
  EXPECT_NEAR(rate_hz, std::min(line_hz, 25.0), 0.015);
  EXPECT_EQ(pls.wrong_scans, 0U);
  const SickCounters counters = pls.driver.status().counters.line;
  EXPECT_EQ(counters.bad_crc + counters.truncated, 0U);
}

INSTANTIATE_TEST_SUITE_P(Rates, PlsRate, ::testing::Values(9600U, 19200U, 38400U, 500'000U));

TEST(PlsDriver, ScansSayWhereTheirBeamsAre) {
  for (const auto& [beams, step_deg] : {std::pair{361, 0.5}, {181, 1.0}, {180, 1.0}}) {
    PlsOnLine pls({}, {}, static_cast<std::size_t>(beams));
    pls.start();
    const LaserScan& scan = pls.scans.back();
    EXPECT_EQ(scan.ranges_m.size(), static_cast<std::size_t>(beams));
    EXPECT_DOUBLE_EQ(scan.angle_min_rad, -90.0 / 180.0 * 3.14159265358979323846);
    EXPECT_DOUBLE_EQ(scan.angle_step_rad, step_deg / 180.0 * 3.14159265358979323846);
    EXPECT_EQ(pls.wrong_scans, 0U);
  }
}

// The world has returns from 0.1 to 10 m, at constant distances.
TEST(PlsDriver, ScansSayWhatIsInTheFieldsOfTheSensor) {
  struct Fields {
    double protective_m, warning_m;
    bool protective, warning;
  };
  PlsOnLine pls;
  pls.start();
  for (const Fields& c : {Fields{0.0, 0.0, false, false}, Fields{0.05, 0.08, false, false},
                          Fields{0.05, 12.0, false, true}, Fields{4.0, 12.0, true, true}}) {
    pls.emulator.set_fields(c.protective_m, c.warning_m);
    ASSERT_TRUE(pls.run_for_scans(4, 10 * kSecond_ns));  // the first may be older
    EXPECT_EQ(pls.scans.back().protective_field, c.protective) << c.protective_m;
    EXPECT_EQ(pls.scans.back().warning_field, c.warning) << c.warning_m;
  }
  EXPECT_EQ(pls.wrong_scans, 0U);
  EXPECT_THROW(pls.emulator.set_fields(4.1, 5.0), std::invalid_argument);
  EXPECT_THROW(pls.emulator.set_fields(1.0, 15.1), std::invalid_argument);
}

TEST(PlsDriver, AsksForEveryScanIfItIsTo) {
  for (const std::uint32_t baud : {9600U, 38400U, 500'000U}) {
    PlsSettings settings;
    settings.output = PlsOutput::kOnRequest;
    settings.baud = baud;
    PlsOnLine pls(settings);
    pls.start();
    EXPECT_FALSE(pls.emulator.streaming());
    const std::size_t before = pls.scans.size();
    pls.run_for(20 * kSecond_ns);
    EXPECT_GE(pls.scans.size(), before + (baud == 9600 ? 18 : 60)) << baud;
    EXPECT_EQ(pls.wrong_scans, 0U);
    EXPECT_EQ(pls.driver.status().counters.timeouts, 0U);
  }
}

TEST(PlsDriver, TellsAnLmsByItsParity) {
  PlsOnLine pls({}, lms());
  pls.start();
  EXPECT_TRUE(pls.driver.status().lms);
  EXPECT_EQ(pls.emulator.line(), (LineSettings{500'000, Parity::kNone}));
  pls.run_for(kSecond_ns);
  EXPECT_EQ(pls.wrong_scans, 0U);
}

TEST(PlsDriver, WaitsForASensorThatIsSwitchedOnLater) {
  PlsOnLine pls;
  pls.emulator.switch_off();
  pls.line.plug_in();
  pls.run_for(30 * kSecond_ns);
  EXPECT_EQ(pls.driver.status().state, PlsState::kFailed);
  EXPECT_THAT(pls.driver.status().reason, HasSubstr("no answer"));
  EXPECT_GE(pls.driver.status().counters.searches, 3U);
  pls.emulator.switch_on(pls.line.now_ns());
  ASSERT_TRUE(pls.run_for_scans(1, 20 * kSecond_ns));
  EXPECT_EQ(pls.driver.status().state, PlsState::kRunning);
  EXPECT_EQ(pls.wrong_scans, 0U);
}

TEST(PlsDriver, StaysAtTheRateWhenThePasswordIsRefused) {
  simulation::PlsEmulatorSettings sensor;
  sensor.password = "12345678";
  PlsOnLine pls({}, sensor);
  pls.start();
  EXPECT_EQ(pls.driver.status().state, PlsState::kRunning);
  EXPECT_EQ(pls.driver.status().line.baud, 9600U);
  EXPECT_THAT(pls.driver.status().reason, HasSubstr("password"));
  PlsSettings settings;
  settings.password_pls = "12345678";
  PlsOnLine other(settings, sensor);
  other.start();
  EXPECT_EQ(other.driver.status().line.baud, 500'000U);
}

TEST(PlsDriver, ComesBackWhenTheSensorDoesNotFollow) {
  PlsOnLine once;
  once.emulator.inject(simulation::PlsFault::kIgnoreBaudSwitch, 1);
  once.start();
  EXPECT_EQ(once.driver.status().line.baud, 500'000U);
  EXPECT_EQ(once.driver.status().reason, "");
  EXPECT_EQ(once.driver.status().counters.switches_not_followed, 1U);
  PlsOnLine never;
  never.emulator.inject(simulation::PlsFault::kIgnoreBaudSwitch, 1000);
  never.start();
  EXPECT_EQ(never.driver.status().line.baud, 9600U);
  EXPECT_EQ(never.driver.status().state, PlsState::kRunning);
  EXPECT_THAT(never.driver.status().reason, HasSubstr("does not switch to 500000 baud"));
  EXPECT_EQ(never.driver.status().counters.switches_not_followed, 2U);
  // It gets another chance after a restart.
  never.emulator.inject(simulation::PlsFault::kIgnoreBaudSwitch, -998);
  never.emulator.switch_on(never.line.now_ns());
  never.scans.clear();
  ASSERT_TRUE(never.line.run_until(20 * kSecond_ns, [&] {
    never.collect();
    return never.driver.status().line.baud == 500'000 && !never.scans.empty();
  }));
}

// A busy machine hears answers too late, as if the sensor did not follow.
TEST(PlsDriver, TriesTheWantedRateAgainWhileScansCome) {
  PlsOnLine pls;
  pls.emulator.inject(simulation::PlsFault::kIgnoreBaudSwitch, 2);
  pls.start();
  ASSERT_EQ(pls.driver.status().line.baud, 9600U);
  EXPECT_TRUE(pls.line.run_until(20 * kSecond_ns, [&] {
    pls.collect();
    return pls.driver.status().line.baud == 500'000;
  }));
  EXPECT_TRUE(pls.run_for_scans(25, 2 * kSecond_ns)) << "25 scans a second";
  EXPECT_EQ(pls.driver.status().reason, "");
  EXPECT_EQ(pls.driver.status().counters.silences, 0U) << "it has not waited for a loss";
}

TEST(PlsDriver, ASensorThatNeverFollowsIsLeftInPeace) {
  PlsOnLine pls;
  pls.emulator.inject(simulation::PlsFault::kIgnoreBaudSwitch, 1000);
  pls.start();
  pls.run_for(1200 * kSecond_ns);
  const std::uint64_t tried = pls.driver.status().counters.switches_not_followed;
  EXPECT_EQ(tried, 14U) << "twice at the start, and each of six times later";
  pls.run_for(1200 * kSecond_ns);
  EXPECT_EQ(pls.driver.status().counters.switches_not_followed, tried);
  EXPECT_EQ(pls.driver.status().state, PlsState::kRunning);
  EXPECT_THAT(pls.driver.status().reason, HasSubstr("does not switch to 500000 baud"));
}

TEST(PlsDriver, WithholdsAScanThatComesAgainAndAgain) {
  PlsSettings settings;
  settings.stuck_scans = 5;
  PlsOnLine pls(settings);
  pls.start();
  pls.still = true;
  pls.run_for(kSecond_ns);
  const std::size_t before = pls.scans.size();
  EXPECT_TRUE(pls.driver.status().stuck);
  EXPECT_THAT(pls.driver.status().reason, HasSubstr("repeats the same scan"));
  pls.run_for(kSecond_ns);
  EXPECT_EQ(pls.scans.size(), before);
  EXPECT_EQ(pls.driver.status().state, PlsState::kRunning);
  EXPECT_NEAR(static_cast<double>(pls.driver.status().counters.scan_drops.stuck), 45.0, 2.0);
  pls.still = false;
  pls.run_for(kSecond_ns);
  EXPECT_FALSE(pls.driver.status().stuck);
  EXPECT_GE(pls.scans.size(), before + 23);
}

TEST(PlsDriver, SaysWhatTheStatusByteSays) {
  PlsOnLine pls;
  pls.start();
  pls.emulator.set_status(0x81);
  pls.run_for(kSecond_ns);
  EXPECT_TRUE(pls.driver.status().health.polluted);
  EXPECT_EQ(pls.driver.status().health.severity, PlsSeverity::kInfo);
  EXPECT_TRUE(pls.scans.back().contaminated);
  pls.emulator.set_status(0x40);
  pls.run_for(kSecond_ns);
  const std::size_t before = pls.scans.size();
  pls.emulator.set_status(0x03);
  pls.run_for(kSecond_ns);
  EXPECT_LE(pls.scans.size(), before + 1);
  const PlsScanDrops drops = pls.driver.status().counters.scan_drops;
  EXPECT_GE(drops.implausible, 23U);
  EXPECT_GE(drops.sensor_error, 23U);
  pls.emulator.set_status(0);
  EXPECT_TRUE(pls.run_for_scans(3, kSecond_ns));
  EXPECT_FALSE(pls.driver.status().health.polluted);
}

TEST(PlsDriver, ReadsTheErrorsOfTheSensor) {
  simulation::PlsEmulatorSettings sensor;
  sensor.errors = {{PlsSeverity::kWarning, 9}, {PlsSeverity::kError, 21}};
  PlsOnLine pls({}, sensor);
  pls.start();
  EXPECT_EQ(pls.driver.status().errors, sensor.errors);
}

TEST(PlsDriver, RepeatsACommandThatTheSensorHeardWrongly) {
  PlsOnLine pls;
  int commands = 0;
  pls.line.set_host_filter([&](std::vector<std::uint8_t>& bytes) {
    if (++commands % 2 == 0) bytes.back() ^= 0x10;
  });
  pls.start();
  const PlsStatus status = pls.driver.status();
  EXPECT_EQ(status.line.baud, 500'000U);
  EXPECT_GE(status.counters.refusals, 3U) << "NAK";
  EXPECT_GE(status.counters.repeats, 3U);
  EXPECT_GE(status.counters.line.naks, 3U);
}

// The emulator of a simulation is behind a pseudo-terminal.
TEST(PlsDriver, ChangesTheRateOfAnEmulatorThatItTakesForAnLms) {
  simulation::LaserEmulatorSettings settings;
  const auto emulator = simulation::make_laser_emulator(
      settings, [](const simulation::BeamPattern& beams, std::int64_t) {
        return std::vector<float>(beams.count, 2.0F);
      });
  const LineSettings host{9600, Parity::kEven};
  emulator->receive(pls_baud_command(500'000).value(), host, 0);
  emulator->tick(kSecond_ns);
  static_cast<void>(emulator->take_output(host, kSecond_ns));
  const LineSettings fast{500'000, Parity::kEven};
  emulator->receive(pls_mode_command(PlsMode::kOnRequest), fast, kSecond_ns);
  EXPECT_FALSE(emulator->take_output(fast, 2 * kSecond_ns).empty());
}

TEST(PlsDriver, StaysAtTheRateWhenTheSensorNeverTakesTheCommand) {
  PlsOnLine pls;
  const Bytes rate = pls_baud_command(500'000).value();
  pls.line.set_host_filter([&](std::vector<std::uint8_t>& bytes) {
    if (bytes == rate) bytes.back() ^= 0x10;
  });
  pls.start();
  EXPECT_EQ(pls.driver.status().line.baud, 9600U);
  EXPECT_EQ(pls.driver.status().reason, "runs at 9600 baud: the sensor refuses 500000 baud");
}

// The sensor hears each command, but answers so late that the driver repeats it. A sensor that
// answers a repeated command ignores the next one.
TEST(PlsDriver, ChangesTheRateOfASensorThatAnswersEachCommandLate) {
  for (std::int64_t late_ms = 110; late_ms <= 300; late_ms += 10) {
    SCOPED_TRACE(late_ms);
    PlsDriver driver(PlsSettings{});
    simulation::PlsEmulator emulator({},
                                     [](std::int64_t) { return std::vector<float>(361, 2.0F); });
    LateDevice sensor(emulator, late_ms * kMillisecond_ns);
    SimulatedLine line(driver, sensor);
    line.plug_in();
    EXPECT_TRUE(line.run_until(30 * kSecond_ns, [&] {
      return driver.status().state == PlsState::kRunning;
    })) << driver.status().reason;
    EXPECT_GT(driver.status().counters.repeats, 0U);
    EXPECT_EQ(driver.status().reason, "");
    EXPECT_EQ(driver.status().line.baud, 500'000U);
  }
}

TEST(PlsDriver, RestsWhenTheSensorRefusesToSendScans) {
  PlsOnLine pls;
  const Bytes stream = pls_mode_command(PlsMode::kStream);
  int asked = 0;
  pls.line.set_host_filter([&](std::vector<std::uint8_t>& bytes) {
    if (bytes != stream) return;
    ++asked;
    bytes.clear();
  });
  pls.line.plug_in();
  pls.run_for(120 * kSecond_ns);
  EXPECT_EQ(pls.driver.status().state, PlsState::kFailed);
  EXPECT_EQ(pls.driver.status().reason, "the sensor does not send scans");
  EXPECT_GE(asked, 20);
  EXPECT_LE(asked, 120) << "once per second at most in the long run";
  pls.line.set_host_filter({});
  EXPECT_TRUE(pls.run_for_scans(1, 10 * kSecond_ns));
}

TEST(PlsDriver, IgnoresTheEchoOfItsCommands) {
  PlsOnLine pls;
  pls.line.set_echo(true);
  pls.start();
  EXPECT_EQ(pls.driver.status().line.baud, 500'000U);
  EXPECT_GE(pls.driver.status().counters.line.echoes, 5U);
  EXPECT_EQ(pls.driver.status().counters.line.noise_bytes, 0U);
  EXPECT_EQ(pls.driver.status().counters.repeats, 0U);
}

TEST(PlsDriver, OrdersNothingWithoutAPort) {
  PlsOnLine pls;
  pls.start();
  pls.line.unplug();
  EXPECT_EQ(pls.driver.status().state, PlsState::kOffline);
  EXPECT_EQ(pls.driver.due_ns(), std::numeric_limits<std::int64_t>::max());
  pls.driver.tick(pls.line.now_ns() + 100 * kSecond_ns);
  EXPECT_THAT(pls.driver.take_orders(), IsEmpty());
}

TEST(PlsSettings, AreChecked) {
  const auto refused = [](const auto& change, const std::string& name) {
    PlsSettings settings;
    change(settings);
    try {
      const PlsDriver driver(settings);
      ADD_FAILURE() << name;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(name));
    }
  };
  EXPECT_NO_THROW(PlsDriver{PlsSettings{}});
  refused([](PlsSettings& s) { s.baud = 57600; }, "baud is 57600");
  refused([](PlsSettings& s) { s.detection_bauds = {}; }, "detection_bauds");
  refused([](PlsSettings& s) { s.detection_bauds = {1200}; }, "detection_bauds is 1200");
  refused([](PlsSettings& s) { s.parities = {}; }, "parities");
  refused([](PlsSettings& s) { s.password_pls = "short"; }, "password_pls is 'short'");
  refused([](PlsSettings& s) { s.tries = 0; }, "tries is 0");
  refused([](PlsSettings& s) { s.settle_ns = -1; }, "settle_ns is -1 ns");
  refused([](PlsSettings& s) { s.scan_period_ns = 0; }, "scan_period_ns");
  refused([](PlsSettings& s) { s.stuck_scans = 1; }, "stuck_scans is 1");
  refused([](PlsSettings& s) { s.range_max_m = 0.0; }, "range_max_m");
}

}  // namespace
}  // namespace topogeo::devices
