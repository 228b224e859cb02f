// A driver and an emulated base at the two ends of a simulated line, wheels on good ground between
// them, and the driver's odometry compared with the true path of the wheels.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "topogeo/devices/rwi_driver.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/simulation/mcp_emulator.hpp"
#include "topogeo/simulation/serial_device.hpp"
#include "topogeo/support/random.hpp"

#include "simulated_line.hpp"

namespace topogeo::devices {

inline constexpr std::int64_t kMs = 1'000'000;
inline constexpr std::int64_t kSecond = 1'000'000'000;

/// The emulated base with wheels that follow the motors, and a history of their poses.
class RollingBase final : public simulation::SerialDevice {
 public:
  explicit RollingBase(const simulation::McpEmulatorSettings& settings) : mcp(settings) {}

  void receive(std::span<const std::uint8_t> bytes, const LineSettings& host,
               std::int64_t now_ns) override {
    if (frozen_) {
      waiting_.emplace_back(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), host);
      return;
    }
    roll(now_ns);
    mcp.receive(bytes, host, now_ns);
  }
  void tick(std::int64_t now_ns) override {
    if (!frozen_) roll(now_ns);
  }
  [[nodiscard]] std::int64_t due_ns() const override {
    if (frozen_) return std::numeric_limits<std::int64_t>::max();
    return std::min(mcp.due_ns(), rolled_ns_ + kStep_ns);
  }
  [[nodiscard]] std::vector<std::uint8_t> take_output(const LineSettings& host,
                                                      std::int64_t now_ns) override {
    return frozen_ ? std::vector<std::uint8_t>{} : mcp.take_output(host, now_ns);
  }

  /// The process of the emulated base waits for a CPU.
  void freeze() { frozen_ = true; }
  /// It goes on as the simulator does.
  void thaw(std::int64_t now_ns) {
    frozen_ = false;
    const std::int64_t standstill_ns =
        std::max<std::int64_t>(0, now_ns - rolled_ns_ - simulation::kLongestCatchUp_ns);
    mcp.stand_still(standstill_ns);
    rolled_ns_ += standstill_ns;
    for (const auto& [bytes, host] : std::exchange(waiting_, {})) {
      mcp.receive(bytes, host, rolled_ns_);
    }
    roll_to(now_ns);
  }

  /// True pose of the wheels, interpolated between the two nearest known times.
  [[nodiscard]] geometry::Pose2 at(std::int64_t stamp_ns) const {
    const auto after = std::ranges::lower_bound(way_, stamp_ns, {}, &Place::first);
    if (after == way_.begin()) return way_.front().second;
    if (after == way_.end()) return way_.back().second;
    const auto before = std::prev(after);
    const double share = static_cast<double>(stamp_ns - before->first) /
                         static_cast<double>(after->first - before->first);
    const Eigen::Vector3d step = geometry::difference(after->second, before->second);
    const geometry::Pose2& from = before->second;
    return {from.x_m + share * step.x(), from.y_m + share * step.y(),
            geometry::wrap_angle(from.theta_rad + share * step.z())};
  }
  /// Forgets all but the last two seconds.
  void trim() {
    const auto keep = std::ranges::lower_bound(way_, rolled_ns_ - 2 * kSecond, {}, &Place::first);
    way_.erase(way_.begin(), keep);
  }
  [[nodiscard]] bool stands() const {
    const geometry::Velocity velocity = mcp.commanded_velocity();
    return velocity.linear_m_per_s == 0.0 && velocity.angular_rad_per_s == 0.0;
  }

  /// Uniform noise of the encoders up to these speeds; a published example: 256 counts/s (MIRO).
  void set_noise(double linear_mps, double angular_radps) {
    noise_mps_ = linear_mps;
    noise_radps_ = angular_radps;
  }

  simulation::McpEmulator mcp;

 private:
  using Place = std::pair<std::int64_t, geometry::Pose2>;
  static constexpr std::int64_t kStep_ns = 5 * kMs;

  void roll_to(std::int64_t to_ns) {
    while (rolled_ns_ < to_ns) roll(std::min(rolled_ns_ + kStep_ns, to_ns));
  }

  void roll(std::int64_t now_ns) {
    const double dt_s = 1e-9 * static_cast<double>(now_ns - rolled_ns_);
    const geometry::Velocity velocity = mcp.commanded_velocity();
    if (dt_s > 0.0) {
      const double linear_mps = velocity.linear_m_per_s + noise_mps_ * random_.uniform(-1.0, 1.0);
      const double angular_radps =
          velocity.angular_rad_per_s + noise_radps_ * random_.uniform(-1.0, 1.0);
      mcp.moved(linear_mps * dt_s, angular_radps * dt_s, dt_s);
    }
    rolled_ns_ = now_ns;
    mcp.tick(now_ns);
    if (way_.empty() || now_ns > way_.back().first) way_.emplace_back(now_ns, mcp.T_start_robot());
  }

  std::vector<Place> way_;
  std::int64_t rolled_ns_ = 0;
  bool frozen_ = false;
  std::vector<std::pair<std::vector<std::uint8_t>, LineSettings>> waiting_;  ///< while it is frozen
  support::Random random_{9};
  double noise_mps_ = 0.0;
  double noise_radps_ = 0.0;
};

/// Both with the same line settings and calibration.
struct BaseOnLine {
  explicit BaseOnLine(const BaseSettings& base_settings,
                      simulation::McpEmulatorSettings emulated = {})
      : settings(base_settings),
        base(matched(base_settings, emulated)),
        driver(base_settings),
        line(driver, base) {}

  static simulation::McpEmulatorSettings matched(const BaseSettings& settings,
                                                 simulation::McpEmulatorSettings emulated) {
    emulated.line = settings.line;
    emulated.calibration = settings.calibration;
    return emulated;
  }

  /// Passes time with a navigator's commands, ten a second (none: silence), and compares.
  void drive(double linear_mps, double angular_radps, std::int64_t duration_ns) {
    for (std::int64_t end_ns = line.now_ns() + duration_ns; line.now_ns() < end_ns;) {
      (void)driver.command(linear_mps, angular_radps, line.now_ns() + kSecond / 2, line.now_ns());
      pass(std::min(kSecond / 10, end_ns - line.now_ns()));
    }
  }
  void pass(std::int64_t duration_ns) {
    line.run_for(duration_ns);
    compare();
  }
  bool pass_until(std::int64_t limit_ns, const auto& done) {
    const bool reached = line.run_until(limit_ns, done);
    compare();
    return reached;
  }
  /// Starts the driver up. False unless it is ready within `limit_ns`.
  bool start(std::int64_t limit_ns = 10 * kSecond) {
    line.plug_in();
    return pass_until(limit_ns, [this] { return driver.status().state == BaseState::kReady; });
  }

  /// Lets time pass until the next odometry.
  bool pass_to_odometry(std::int64_t limit_ns) {
    const std::uint64_t before = all_odometries;
    return line.run_until(limit_ns, [&] {
      compare();
      return all_odometries > before;
    });
  }

  /// Takes the odometry and compares it with the true poses at its stamps.
  void compare() {
    for (const BaseOdometry& odometry : driver.take_odometry()) {
      if (last_stamp_ns >= odometry.stamp_ns) ++stamps_back;
      if (odometry.stamp_ns > line.now_ns()) ++stamps_ahead;
      last_stamp_ns = odometry.stamp_ns;
      ++odometries;
      ++all_odometries;
      const geometry::Pose2 T_start_robot = base.at(odometry.stamp_ns);
      if (odometries == 1) T_odom_start = odometry.T_odom_robot * geometry::inverse(T_start_robot);
      const Eigen::Vector3d error =
          geometry::difference(odometry.T_odom_robot, T_odom_start * T_start_robot);
      if (error.head<2>().norm() > right_m || std::abs(error.z()) > right_rad) ++wrong;
      worst_m = std::max(worst_m, error.head<2>().norm());
      worst_rad = std::max(worst_rad, std::abs(error.z()));
      T_odom_robot = odometry.T_odom_robot;
    }
    base.trim();
  }
  /// Compares with the present pose from here on: after motion that the driver could not see.
  void compare_anew() {
    compare();
    odometries = 0;
  }

  BaseSettings settings;
  RollingBase base;
  RwiDriver driver;
  SimulatedLine line;
  std::uint64_t odometries = 0;  ///< since the comparison began
  std::uint64_t all_odometries = 0;
  std::uint64_t stamps_back = 0;
  std::uint64_t stamps_ahead = 0;
  std::int64_t last_stamp_ns = -1;
  double right_m = 0.03;  ///< odometry with a larger error is wrong
  double right_rad = 0.03;
  std::uint64_t wrong = 0;
  double worst_m = 0.0;
  double worst_rad = 0.0;
  geometry::Pose2 T_odom_start{};
  geometry::Pose2 T_odom_robot{};
};

}  // namespace topogeo::devices
