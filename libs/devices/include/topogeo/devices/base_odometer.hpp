// Odometry from the reports of an RWI base: the base's own clock on the host's, its registers as
// one pose that no restart of the base and no end of a register makes jump.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/mcp_protocol.hpp"
#include "topogeo/devices/mcp_units.hpp"
#include "topogeo/geometry/pose2.hpp"

namespace topogeo::devices {

struct BaseOdometry {
  std::int64_t stamp_ns = 0;  ///< when the base took it, on the host's clock
  geometry::Pose2 T_odom_robot{};
  double linear_mps = 0.0;     ///< along x of the robot
  double angular_radps = 0.0;  ///< counter-clockwise
};

/// Where the odometry was: what another life of the program needs to go on with it, as long as the
/// base counts on.
struct OdometerState {
  McpReport report{};            ///< the last that was accepted
  std::int64_t arrival_ns = 0;   ///< when it came, on the host's steady clock
  geometry::Pose2 T_odom_robot;  ///< what it meant
};

/// A device's clock on the host's steady clock: messages come late by varying times but never
/// early, so that the least delay of the last seconds shows the offset between the clocks.
class DeviceClock {
 public:
  /// `transmission_ns`: what even the least delayed message took.
  explicit DeviceClock(std::int64_t transmission_ns) : transmission_ns_(transmission_ns) {}

  /// Host time of the device's time `device_ns`, of a message that arrived at `arrival_ns`.
  /// Later than every answer before, never later than the arrival unless it must be; runs at most
  /// 2 % faster or slower than the device's clock.
  std::int64_t map(std::int64_t device_ns, std::int64_t arrival_ns);
  /// How much later than the least delayed ones a message came; negative if earlier, but never in
  /// the first seconds. 0 before the first.
  [[nodiscard]] std::int64_t lateness_ns(std::int64_t device_ns, std::int64_t arrival_ns) const;
  /// The device's clock starts anew.
  void restart() { started_ = false; }

 private:
  void settle(std::int64_t device_ns, std::int64_t offset_ns);

  std::int64_t transmission_ns_;
  bool started_ = false;
  std::int64_t first_device_ns_ = 0;
  std::int64_t last_device_ns_ = 0;
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::int64_t offset_ns_ = 0;  // host time - device time, as used
  std::int64_t least_ns_ = 0;   // of the offsets of this window
  std::int64_t before_ns_ = 0;  // of the window before
  std::int64_t window_ns_ = 0;  // where this window began, device time
};

class BaseOdometer {
 public:
  explicit BaseOdometer(const BaseSettings& settings);

  enum class Verdict : std::uint8_t {
    kGood,
    kImplausible,  ///< no base can have sent it after the one before
    kRestarted     ///< the second in succession with another clock; usable
  };
  struct Result {
    Verdict verdict = Verdict::kGood;
    BaseOdometry odometry{};  ///< unless implausible
  };
  Result take(const McpReport& report, std::int64_t arrival_ns);

  /// Goes on from there if the first reports show that the base has counted on since: its clock
  /// went as the host's, and it is no further than a base can have driven. Before the first report.
  void resume(const OdometerState& state) { resumed_ = state; }
  /// Whether it went on; false before the first odometry, and when it began anew.
  [[nodiscard]] bool has_resumed() const { return has_resumed_; }
  /// Empty before the first odometry.
  [[nodiscard]] std::optional<OdometerState> state() const;

 private:
  /// What of a report the next one is compared with.
  struct Reference {
    McpReport report{};
    std::int64_t arrival_ns = 0;
  };
  [[nodiscard]] bool clock_follows(const McpReport& report, std::int64_t arrival_ns) const;
  [[nodiscard]] bool follows_doubted(const McpReport& report, std::int64_t arrival_ns) const;
  [[nodiscard]] bool moved_plausibly(const McpReport& from, const McpReport& to,
                                     std::int64_t elapsed_ns, bool loosely) const;
  BaseOdometry accept(const McpReport& report, std::int64_t arrival_ns);
  [[nodiscard]] bool counted_on(const McpReport& report, std::int64_t arrival_ns) const;
  Result begin(const McpReport& report, std::int64_t arrival_ns);
  void start_from(const McpReport& report);

  McpUnits units_;
  BaseLimits limits_;
  McpPoseTracker tracker_;
  McpClock base_clock_;
  DeviceClock host_clock_;
  std::optional<Reference> last_{};     // accepted
  std::optional<Reference> doubted_{};  // since then
  unsigned doubts_ = 0;
  std::int64_t base_ns_ = 0;
  geometry::Pose2 T_odom_base_{};
  geometry::Pose2 T_odom_robot_{};
  std::optional<OdometerState> resumed_{};  // until the first odometry
  bool has_resumed_ = false;
};

}  // namespace topogeo::devices
