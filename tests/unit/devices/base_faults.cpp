#include "base_faults.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <stdexcept>

#include "topogeo/support/random.hpp"

#include "base_on_line.hpp"

namespace topogeo::devices {
namespace {

using support::Random;

/// Time to halt from full speed. The wheels may turn for so long after a stop and still count as
/// stopped.
constexpr std::int64_t kHalting = 2 * kSecond;
constexpr std::int64_t kLongestOff = 20 * kSecond;

/// A fault in progress.
struct Scene {
  BaseOnLine& all;
  Random& random;
  std::int64_t period_ns;
  std::size_t& unsafe;

  void drive(std::int64_t duration_ns) {
    all.drive(random.uniform(-0.3, 0.4), random.uniform(-0.5, 0.5), duration_ns);
  }
  std::int64_t some(std::int64_t low_ns, std::int64_t high_ns) {
    return low_ns +
           static_cast<std::int64_t>(random.below(static_cast<std::uint64_t>(high_ns - low_ns)));
  }
  unsigned few() { return 1 + static_cast<unsigned>(random.below(5)); }
  void must_stand() {
    if (!all.base.stands()) ++unsafe;
  }
};

/// Returns the time when the fault is over.
using InjectInBase = std::int64_t (*)(Scene&);
using BaseCount = std::uint64_t (*)(const BaseStatus&);

struct BaseFault {
  const char* name;
  const char* counted_as;
  BaseCount count;
  InjectInBase inject;
  std::int64_t allowed_ns = 0;  ///< 0: two report periods
  double right_m = 0.03;
};

std::uint64_t drops(const BaseStatus& status) {
  return std::accumulate(status.drops.begin(), status.drops.end(), std::uint64_t{0});
}
std::uint64_t starts(const BaseStatus& status) {
  return status.starts;
}
std::uint64_t restarts(const BaseStatus& status) {
  return status.restarts;
}
std::uint64_t expirations(const BaseStatus& status) {
  return status.watchdog_expirations;
}
std::uint64_t echoes(const BaseStatus& status) {
  return status.echoes;
}
/// For faults that the state shows, see must_be().
std::uint64_t anything_at_all(const BaseStatus& /*status*/) {
  static std::uint64_t calls = 0;
  return ++calls;
}

/// Counts as unsafe unless the state is published while the fault lasts.
void must_be(BaseState state, Scene& scene) {
  if (scene.all.driver.status().state != state) ++scene.unsafe;
}

/// Drives until the base has sent as many damaged reports as ordered.
std::int64_t strike_base(Scene& scene, unsigned reports) {
  const std::uint64_t last = scene.all.base.mcp.reports() + reports;
  while (scene.all.base.mcp.reports() < last) scene.drive(10 * kMs);
  // The last report is still in transit.
  scene.drive(report_line_time_ns(scene.all.settings));
  return scene.all.line.now_ns();
}

std::int64_t corrupt(Scene& scene) {
  const unsigned reports = scene.few();
  scene.all.base.mcp.line_faults().corrupt(reports);
  return strike_base(scene, reports);
}

std::int64_t truncate(Scene& scene) {
  const unsigned reports = scene.few();
  scene.all.base.mcp.line_faults().truncate(reports);
  return strike_base(scene, reports);
}

std::int64_t garbage(Scene& scene) {
  const std::size_t bytes = 2 + scene.random.below(60);
  scene.all.base.mcp.send_garbage(bytes, scene.all.line.now_ns());
  scene.drive(line_time_ns(bytes, scene.all.settings.line));
  return scene.all.line.now_ns();
}

std::int64_t short_silence(Scene& scene) {
  scene.all.base.mcp.line_faults().set_silent(true);
  scene.drive(scene.some(kMs, 2 * scene.period_ns));
  scene.all.base.mcp.line_faults().set_silent(false);
  return scene.all.line.now_ns();
}

std::int64_t long_silence(Scene& scene) {
  scene.all.base.mcp.line_faults().set_silent(true);
  scene.drive(scene.some(kSecond, 10 * kSecond));
  must_be(BaseState::kOffline, scene);
  scene.all.base.mcp.line_faults().set_silent(false);
  return scene.all.line.now_ns();
}

std::int64_t unplug_base(Scene& scene) {
  scene.all.line.unplug();
  const std::int64_t gone_ns = scene.some(kMs, 6 * kSecond);
  scene.drive(gone_ns);
  must_be(BaseState::kOffline, scene);
  if (gone_ns > kSecond + kHalting) scene.must_stand();  // the watchdog and the halt
  scene.all.line.plug_in();
  return scene.all.line.now_ns();
}

std::int64_t restart_base(Scene& scene) {
  // The distance between its last report and the loss of power is unknown.
  if (scene.random.below(2) == 0) scene.all.pass(kHalting);
  const geometry::Pose2 before = scene.all.T_odom_robot;
  scene.all.base.mcp.switch_off(scene.all.line.now_ns());
  scene.drive(scene.some(kMs, kLongestOff));
  scene.must_stand();
  scene.all.base.mcp.switch_on(scene.all.line.now_ns());
  (void)scene.all.line.run_until(10 * kSecond, [&] { return scene.all.base.mcp.ready(); });
  const std::int64_t end_ns = scene.all.line.now_ns();
  scene.all.compare_anew();
  (void)scene.all.pass_to_odometry(10 * kSecond);
  if (geometry::difference(scene.all.T_odom_robot, before).norm() > 0.02) ++scene.all.wrong;
  return end_ns;
}

std::int64_t echo_on(Scene& scene) {
  scene.all.base.mcp.set_echo(true);
  scene.drive(4 * kSecond);
  if (scene.all.base.mcp.echoes()) ++scene.unsafe;
  return scene.all.line.now_ns();
}

std::int64_t other_watchdog(Scene& scene) {
  std::vector<std::uint8_t> bytes;
  const McpOrder order{McpCommand::kWatchdog, 1};
  if (scene.all.settings.dialect == BaseDialect::kAscii) {
    append_ascii({McpCommand::kTranslateWhere}, bytes);  // terminates a line that may have begun
    append_ascii(order, bytes);
  } else {
    const McpPacket packet = binary_packet(order);
    bytes.assign(packet.begin(), packet.end());
  }
  // The driver may be refreshing its own watchdog.
  const std::uint64_t before = scene.all.driver.status().watchdog_expirations;
  while (scene.all.driver.status().watchdog_expirations == before) {
    scene.all.base.receive(bytes, scene.all.settings.line, scene.all.line.now_ns());
    scene.all.pass(kSecond / 10);
  }
  scene.all.pass(kHalting);
  must_be(BaseState::kWatchdogExpired, scene);
  scene.must_stand();
  return scene.all.line.now_ns();
}

std::int64_t commands_cease(Scene& scene) {
  scene.all.base.mcp.forget_orders();
  const std::int64_t start_ns = scene.all.line.now_ns();
  const auto halted = [&] {
    return std::ranges::count(scene.all.base.mcp.orders(), McpOrder{McpCommand::kTranslateHalt}) >
           0;
  };
  (void)scene.all.pass_until(5 * kSecond, halted);
  if (scene.all.line.now_ns() - start_ns > kSecond * 6 / 10) ++scene.unsafe;
  scene.all.pass(kHalting);
  scene.must_stand();
  return scene.all.line.now_ns();
}

std::int64_t emergency_stop(Scene& scene) {
  scene.all.drive(0.3, 0.2, kSecond);
  scene.all.base.mcp.press_emergency_stop();
  scene.all.drive(0.3, 0.2, kHalting);
  must_be(BaseState::kEmergencyStop, scene);
  scene.all.base.mcp.release_emergency_stop();
  const geometry::Pose2 before = scene.all.base.mcp.T_start_robot();
  scene.all.drive(0.3, 0.2, kHalting);
  if (scene.all.base.mcp.T_start_robot() != before) ++scene.unsafe;
  scene.all.driver.reset_stop(scene.all.line.now_ns());
  return scene.all.line.now_ns();
}

std::int64_t joystick(Scene& scene) {
  scene.all.drive(0.2, 0.0, 3 * kSecond);
  scene.all.base.mcp.forget_orders();
  for (int i = 0; i < 20; ++i) {
    scene.all.base.mcp.take_joystick({-0.3, scene.random.uniform(-0.5, 0.5)});
    scene.all.drive(0.2, 0.0, kSecond / 10);
  }
  must_be(BaseState::kJoystick, scene);
  if (std::ranges::count(scene.all.base.mcp.orders(), McpOrder{McpCommand::kTranslateHalt}) == 0) {
    ++scene.unsafe;
  }
  scene.all.base.mcp.take_joystick({});
  scene.all.drive(0.2, 0.0, kSecond);
  scene.must_stand();  // until it has stood still for a second
  return scene.all.line.now_ns();
}

BaseSettings base_settings_for(const BaseFaultLine& line) {
  BaseSettings settings;
  settings.dialect = line.dialect;
  settings.line.baud = line.baud;
  return settings;
}

std::int64_t period_ns(const BaseFaultLine& line) {
  return ticks_ns(report_period_ticks(base_settings_for(line)));
}

std::vector<BaseFault> base_faults(const BaseFaultLine& line) {
  const bool ascii = line.dialect == BaseDialect::kAscii;
  // Without a checksum, one report with a wrong digit is accepted up to the distance that the robot
  // may have driven, and those after it are doubted first.
  std::vector<BaseFault> all{
      {"a bit of a report wrong", ascii ? "" : "drops", ascii ? anything_at_all : drops, corrupt,
       ascii ? 3 * period_ns(line) : 0, ascii ? 0.4 : 0.03},
      {"truncated report", "drops", drops, truncate},
      {"garbage", "drops", drops, garbage},
      {"silence below the limit", "", anything_at_all, short_silence},
      {"silence of 1 to 10 s", "", anything_at_all, long_silence},
      {"port unplugged", "starts", starts, unplug_base, kSecond},
      // It is probed every twentieth of its silence so far.
      {"base restarts", "restarts", restarts, restart_base, kSecond + kLongestOff / 20},
      {"watchdog expires", "watchdog_expirations", expirations, other_watchdog},
      {"motion commands cease", "", anything_at_all, commands_cease},
      {"emergency stop", "", anything_at_all, emergency_stop},
      {"joystick taken", "", anything_at_all, joystick},
  };
  if (ascii) all.push_back({"echo on", "echoes", echoes, echo_on});
  return all;
}

}  // namespace

std::vector<BaseFaultTest> base_fault_tests(const BaseFaultLine& line) {
  std::vector<BaseFaultTest> tests;
  for (const BaseFault& fault : base_faults(line)) {
    tests.push_back({fault.name, fault.counted_as,
                     fault.allowed_ns == 0 ? 2 * period_ns(line) : fault.allowed_ns,
                     fault.right_m});
  }
  return tests;
}

BaseFaultResult run_base_fault(const BaseFaultTest& test, const BaseFaultLine& line,
                               std::size_t times, std::uint64_t seed) {
  const std::vector<BaseFault> all = base_faults(line);
  const auto fault = std::ranges::find(all, test.name, &BaseFault::name);
  if (fault == all.end()) throw std::invalid_argument("no fault is called " + test.name);
  Random random(seed);
  BaseOnLine base(base_settings_for(line), {.seed = seed});
  base.right_m = base.right_rad = test.right_m;
  if (!base.start()) throw std::logic_error("the base does not start");
  BaseFaultResult result;
  Scene scene{base, random, period_ns(line), result.unsafe};
  for (result.times = 0; result.times < times; ++result.times) {
    base.drive(random.uniform(0.1, 0.4), random.uniform(-0.5, 0.5),
               scene.some(kSecond, 3 * kSecond));
    const std::uint64_t counted = fault->count(base.driver.status());
    const std::uint64_t odometries = base.all_odometries;
    const std::int64_t end_ns = fault->inject(scene);
    const bool waited = fault->inject == restart_base && base.all_odometries > odometries;
    if (!waited && !base.pass_to_odometry(100 * kSecond)) throw std::logic_error("no recovery");
    const std::int64_t recovery_ns = base.line.now_ns() - end_ns;
    result.worst_recovery_ns = std::max(result.worst_recovery_ns, recovery_ns);
    if (recovery_ns > test.allowed_ns) ++result.late;
    base.pass(2 * kSecond);
    if (!base.driver.status().commands_taken) ++result.unsafe;
    if (fault->count(base.driver.status()) == counted) ++result.uncounted;
  }
  result.odometries = base.all_odometries;
  result.wrong = base.wrong + base.stamps_back + base.stamps_ahead;
  result.worst_m = base.worst_m;
  result.worst_rad = base.worst_rad;
  return result;
}

}  // namespace topogeo::devices
