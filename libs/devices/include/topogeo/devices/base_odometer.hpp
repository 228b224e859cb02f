// Odometry from the reports of an RWI base: maps the base's clock to the host's, and its registers
// to one pose that does not jump when the base restarts or a register overflows.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "topogeo/devices/base_settings.hpp"
#include "topogeo/devices/device_clock.hpp"
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
  /// Whether the odometry continued; false before its first pose, and if it restarted.
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
