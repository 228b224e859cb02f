// Odometry from the reports of an RWI base: maps the base's clock to the host's, and its registers
// to one pose that does not jump when the base restarts or a register overflows.
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
  std::int64_t stamp_ns = 0;  ///< when the base measured it, on the host's clock
  geometry::Pose2 T_odom_robot{};
  double linear_mps = 0.0;     ///< along x of the robot
  double angular_radps = 0.0;  ///< counter-clockwise
};

/// State of the odometry that another life of the program needs to continue it, if the base was not
/// switched off.
struct OdometerState {
  McpReport report{};            ///< the last accepted one
  std::int64_t arrival_ns = 0;   ///< its arrival, on the host's steady clock
  geometry::Pose2 T_odom_robot;  ///< the pose it gave
};

/// Maps a device's clock to the host's steady clock: messages come late by varying times but never
/// early, so the least delay of the last seconds shows the offset between the clocks.
class DeviceClock {
 public:
  /// `transmission_ns`: time that even the least delayed message takes.
  explicit DeviceClock(std::int64_t transmission_ns) : transmission_ns_(transmission_ns) {}

  /// Host time of the device's time `device_ns`, for a message that arrived at `arrival_ns`. Later
  /// than every earlier result, and not later than the arrival unless that requires it; runs at
  /// most 2 % faster or slower than the device's clock.
  std::int64_t map(std::int64_t device_ns, std::int64_t arrival_ns);
  /// Delay of a message relative to the least delayed ones; negative if earlier, but not in the
  /// first seconds. 0 before the first.
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
  std::int64_t offset_ns_ = 0;  // host time - device time, as applied
  std::int64_t least_ns_ = 0;   // least offset of this window
  std::int64_t before_ns_ = 0;  // least offset of the previous window
  std::int64_t window_ns_ = 0;  // start of this window, device time
};

class BaseOdometer {
 public:
  explicit BaseOdometer(const BaseSettings& settings);

  enum class Verdict : std::uint8_t {
    kGood,
    kImplausible,  ///< no base can have sent it after the previous one
    kRestarted     ///< the second in succession on a new clock; usable
  };
  struct Result {
    Verdict verdict = Verdict::kGood;
    BaseOdometry odometry{};  ///< unless implausible
  };
  Result take(const McpReport& report, std::int64_t arrival_ns);

  /// Continues from `state` if the first reports show that the base was not switched off: its clock
  /// kept pace with the host's, and it is no further than a base can have driven. Call before the
  /// first report.
  void resume(const OdometerState& state) { resumed_ = state; }
  /// Whether it continued; false before the first odometry, and if it began anew.
  [[nodiscard]] bool has_resumed() const { return has_resumed_; }
  /// Empty before the first odometry.
  [[nodiscard]] std::optional<OdometerState> state() const;

 private:
  /// The part of a report that the next one is compared with.
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
  std::optional<Reference> last_{};     // last accepted report
  std::optional<Reference> doubted_{};  // last doubted one since
  unsigned doubts_ = 0;
  std::int64_t base_ns_ = 0;
  geometry::Pose2 T_odom_base_{};
  geometry::Pose2 T_odom_robot_{};
  std::optional<OdometerState> resumed_{};  // until the first odometry
  bool has_resumed_ = false;
};

}  // namespace topogeo::devices
