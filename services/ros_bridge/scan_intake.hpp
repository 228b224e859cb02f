// Combines scans and odometry of ROS: each scan gets the odometry of its time; all scans get one
// beam pattern. Unusable inputs are counted by reason.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/frame_tree.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"
#include "topogeo/ros_conversions/messages.hpp"
#include "topogeo/scan/no_return.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::ros_bridge {

/// Why an input was not used.
enum class IntakeDrop : std::uint8_t {
  kInvalidScan,
  kOtherFrame,     ///< the first scan came from another laser
  kNoOdometry,     ///< before the first odometry, or too long after the last
  kNoMounting,     ///< no transform between the frames of robot and laser
  kTilted,         ///< the laser does not scan parallel to the floor
  kOtherMounting,  ///< the configuration has the laser elsewhere
  kOldScan,        ///< not newer than the previous scan
  kOtherBeams,     ///< neither those of the first scan nor a part of them
  kInvalidOdometry,
  kOldOdometry
};
inline constexpr std::size_t kIntakeDrops = 10;
/// Text for people.
std::string_view describe(IntakeDrop drop);

struct IntakeOptions {
  geometry::Pose2 T_robot_laser;      ///< from the configuration of our services
  bool mounting_from_tf = true;       ///< false: the laser is where it is configured, upright
  std::int64_t odometry_wait_ns = 0;  ///< longest wait of a scan for odometry; >= 0
  std::int64_t longest_extrapolation_ns = 0;  ///< see OdometryTrack
  std::size_t most_beams = 2048;              ///< scans with more are thinned out
  ros::SweepOrder sweep = ros::SweepOrder::kNone;
  double range_limit_m = 1e9;    ///< ranges at or above it are no echo
  bool detect_no_return = true;  ///< see CarmenLogOptions
  /// Scans need no odometry, and have the times of their beams. Without a frame of the robot, the
  /// laser is where it is configured.
  bool without_odometry = false;
};

/// Arrival times are of a steady clock; stamps are those of the messages.
class ScanIntake {
 public:
  explicit ScanIntake(const IntakeOptions& options) : options_(options), track_(0) { begin(); }

  /// Sets the robot's frame, to which mountings and odometry refer.
  void set_robot_frame(const std::string& frame) { robot_frame_ = frame; }
  ros::FrameTree& frames() { return frames_; }

  /// Adds the robot's pose by odometry. A stamp over a second before the last one, or a pose that
  /// no robot can have reached since, begins another epoch: returns the reason, else an empty text.
  std::string add(const geometry::OdometrySample& sample);
  void add(const ros::LaserScan& message, std::int64_t arrival_ns);
  void count(IntakeDrop drop, const std::string& detail);

  struct Leaving {
    scan::Scan scan;
    std::int64_t arrival_ns = 0;
  };
  /// The scans that can be published by now, in order.
  std::vector<Leaving> take(std::int64_t now_ns);
  /// Latest time at which take() returns something; the largest number while nothing waits.
  [[nodiscard]] std::int64_t due_ns() const;

  /// Mounting of the last scan's laser; empty until the first known mounting.
  [[nodiscard]] const std::optional<ros::LaserMounting>& mounting() const { return mounting_; }
  [[nodiscard]] std::uint64_t epochs() const { return epochs_; }
  /// Number of the next scan in the current epoch.
  [[nodiscard]] std::uint64_t scans() const { return next_sequence_; }
  [[nodiscard]] std::uint64_t adapted() const { return adapted_; }
  /// The range that the laser reports for no echo, found on the way; later scans have no return
  /// there. Empty if there is none below the range limit of the options.
  [[nodiscard]] const std::optional<scan::NoReturn>& no_return() const {
    return no_return_.found();
  }
  [[nodiscard]] std::uint64_t dropped(IntakeDrop drop) const {
    return drops_[static_cast<std::size_t>(drop)];
  }
  /// The last detail for a reason.
  [[nodiscard]] const std::string& detail(IntakeDrop drop) const {
    return details_[static_cast<std::size_t>(drop)];
  }

 private:
  struct Waiting {
    ros::LaserScan message;
    std::int64_t arrival_ns = 0;
  };

  void begin();
  [[nodiscard]] bool find_mounting(const std::string& laser_frame);
  std::optional<scan::Scan> finish(const ros::LaserScan& message);
  std::optional<scan::Scan> finish(const ros::Sweep& sweep, std::int64_t stamp_ns);
  std::vector<float> ranges_of(const ros::Sweep& sweep, std::int64_t stamp_ns,
                               const geometry::Pose2& T_odom_robot);
  /// Begins another epoch for a scan without odometry whose clock was set back.
  void follow_clock(std::int64_t stamp_ns);

  IntakeOptions options_;
  std::string robot_frame_;
  ros::FrameTree frames_;
  geometry::OdometryTrack track_;
  std::optional<geometry::OdometrySample> last_odometry_;
  std::deque<Waiting> waiting_;
  std::optional<std::string> laser_frame_;
  std::optional<ros::LaserMounting> mounting_;
  std::optional<ros::BeamPattern> pattern_;  // of the first scan; all later ones are adapted to it
  std::int64_t last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  std::uint64_t next_sequence_ = 0;
  std::uint64_t epochs_ = 0;
  std::uint64_t adapted_ = 0;
  scan::NoReturnWatch no_return_;
  std::array<std::uint64_t, kIntakeDrops> drops_{};
  std::array<std::string, kIntakeDrops> details_{};
};

}  // namespace topogeo::ros_bridge
