#include "ros_bridge_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/msg/types.h"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"

#include "checks.hpp"
#include "ros_bridge/odometry_samples.hpp"
#include "ros_bridge/orders.hpp"
#include "ros_bridge/scan_intake.hpp"

namespace topogeo::fuzz {
namespace {

using ros_bridge::IntakeDrop;
using ros_bridge::ScanIntake;

constexpr std::int64_t kTick_ns = 100'000'000;
/// The longest `transforms.tolerance_s`.
constexpr std::int64_t kTolerance_ns = 5'000'000'000;

// Output of the bridge.

/// The bridge would mistake std::invalid_argument for an unusable message.
template <class Call>
void require_no_refusal(const Call& call, const char* promise) {
  try {
    call();
  } catch (const std::invalid_argument&) {
    throw BrokenPromise(promise);
  }
}

/// Our message, made by the bridge, must pass the checks of its readers and their conversion.
template <class Message, class FromMsg>
void check_leaving(const Message& message, const FromMsg& from_msg) {
  require(!messaging::TopicTraits<Message>::info().find_defect(&message),
          "a message that the bridge makes has no defect");
  require_no_refusal([&] { static_cast<void>(from_msg(message)); },
                     "readers take a message that the bridge makes");
}

/// A pose must be finite and small enough for finite sums and products, with its angle in one turn.
void check_pose(const geometry::Pose2& pose) {
  constexpr double kFarthest_m = 1e12;
  require(std::fabs(pose.x_m) <= kFarthest_m && std::fabs(pose.y_m) <= kFarthest_m &&
              std::fabs(pose.theta_rad) <= std::numbers::pi,
          "a pose is one that can be worked with");
}

void check_leaving(const geometry::OdometrySample& sample) {
  check_pose(sample.T_odom_robot);
  check_leaving(ros_bridge::to_msg(sample, "robot", 1, 0),
                [](const msg::Odometry& message) { return service::odometry_from_msg(message); });
  // Timers of the bridge publish with this time, and an exception there would end it.
  require_no_refusal(
      [&] {
        static_cast<void>(ros::time_of(ros::usable_stamp_ns(sample.stamp_ns) + kTolerance_ns));
      },
      "a message of ROS can state the time of the sensors");
  require(std::isfinite(sample.linear_mps) && std::isfinite(sample.angular_radps),
          "speeds of odometry are finite");
}

void check_leaving(const scan::Scan& scan) {
  check_pose(scan.T_odom_robot);
  check_leaving(service::to_msg(scan, "robot"),
                [](const msg::Scan& message) { return service::from_msg(message); });
}

// Scans through the intake, for each mounting of a laser and each order of its rays.

struct IntakeRun {
  ScanIntake intake;
  std::uint64_t scans = 0;  ///< received

  explicit IntakeRun(ros::SweepOrder sweep, const std::string& laser_frame = "laser",
                     bool upside_down = false)
      : intake(options_of(sweep)) {
    intake.set_robot_frame("base_link");
    Eigen::Isometry3d T_robot_laser = Eigen::Isometry3d::Identity();
    T_robot_laser.translation().x() = kRosMounting.x_m;
    if (upside_down) T_robot_laser.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
    intake.frames().put("base_link", laser_frame, T_robot_laser);
  }

  static ros_bridge::IntakeOptions options_of(ros::SweepOrder sweep) {
    ros_bridge::IntakeOptions options;
    options.T_robot_laser = kRosMounting;
    options.longest_extrapolation_ns = 5 * kTick_ns;
    options.most_beams = msg::kMaxBeams;
    options.sweep = sweep;
    return options;
  }

  void add(const geometry::OdometrySample& sample) { static_cast<void>(intake.add(sample)); }
  void add(const ros::LaserScan& scan) {
    intake.add(scan, kRosNow_ns);
    ++scans;
  }

  /// Returns the output scans; requires that each of the others is counted by its reason.
  std::vector<ScanIntake::Leaving> finish() {
    std::vector<ScanIntake::Leaving> leaving = intake.take(kRosNow_ns);
    for (const ScanIntake::Leaving& scan : leaving) check_leaving(scan.scan);
    std::uint64_t dropped = 0;
    for (std::size_t i = 0; i < ros_bridge::kIntakeDrops; ++i) {
      const auto drop = static_cast<IntakeDrop>(i);
      if (drop == IntakeDrop::kInvalidOdometry || drop == IntakeDrop::kOldOdometry) continue;
      dropped += intake.dropped(drop);
    }
    // Pending scans are not counted when another odometry begins.
    require(intake.epochs() > 1 || leaving.size() + dropped == scans,
            "a scan leaves or is counted");
    if (const auto& mounting = intake.mounting()) check_pose(mounting->T_robot_laser);
    return leaving;
  }
};

constexpr std::array kSweeps = {ros::SweepOrder::kNone, ros::SweepOrder::kForward,
                                ros::SweepOrder::kBackward};

/// Whether any scan is output, with scans before and after each odometry sample.
bool drive(ros::SweepOrder sweep, const std::vector<geometry::OdometrySample>& samples) {
  IntakeRun run(sweep);
  for (const geometry::OdometrySample& sample : samples) {
    run.add(sample);
    for (const std::int64_t after_ns : {-kTick_ns / 2, kTick_ns / 2, 3 * kTick_ns}) {
      run.add(scan_at(sample.stamp_ns + after_ns));
    }
  }
  return !run.finish().empty();
}

bool check_odometry(const geometry::OdometrySample& sample) {
  check_leaving(sample);
  geometry::OdometrySample before = sample;
  before.stamp_ns -= kTick_ns;
  geometry::OdometrySample at_start{before.stamp_ns, {}, 0.1, 0.1};
  geometry::OdometrySample after = at_start;
  after.stamp_ns += 2 * kTick_ns;
  bool taken = false;
  for (const ros::SweepOrder sweep : kSweeps) {
    taken = drive(sweep, {sample}) || taken;
    taken = drive(sweep, {before, sample, after}) || taken;
    taken = drive(sweep, {at_start, sample, after}) || taken;
  }
  return taken;
}

/// A scan of the laser at the end of the message's chain of frames, if the chain is complete.
bool check_frames(const ros::TFMessage& message) {
  IntakeRun run(ros::SweepOrder::kForward);
  std::size_t kept = 0;
  for (const ros::TransformStamped& transform : message.transforms_()) {
    const auto T_parent_child = ros::isometry_of(transform.transform_());
    if (!T_parent_child) continue;
    require(T_parent_child->matrix().allFinite(), "a transform is finite");
    const std::string parent = ros::frame_name(transform.header_().frame_id_());
    const std::string child = ros::frame_name(transform.child_frame_id_());
    if (run.intake.frames().put(parent, child, *T_parent_child)) ++kept;
  }
  for (const ros::FrameTree::Edge& edge : run.intake.frames().edges()) {
    require(
        edge.parent.size() <= ros::kLongestFrameName && edge.child.size() <= ros::kLongestFrameName,
        "the names of frames that are kept are short");
  }
  run.add({kRosNow_ns, {}, 1.0, 1.0});
  run.add({kRosNow_ns + kTick_ns, {0.1, 0.0, 0.1}, 1.0, 1.0});
  if (!message.transforms_().empty()) {
    run.add(scan_at(kRosNow_ns, message.transforms_().back().child_frame_id_()));
  }
  run.add(scan_at(kRosNow_ns + kTick_ns));
  static_cast<void>(run.finish());
  return kept > 0;
}

/// Tests each transform as a successive one from odom to robot.
bool check_odometry_transforms(const ros::TFMessage& message) {
  std::optional<geometry::OdometrySample> last;
  std::vector<geometry::OdometrySample> samples;
  for (const ros::TransformStamped& transform : message.transforms_()) {
    if (transform.child_frame_id_().size() > ros::kLongestFrameName) continue;
    const auto sample = ros_bridge::to_sample(transform, last);
    if (!sample) continue;
    check_leaving(*sample);
    samples.push_back(*sample);
    last = sample;
  }
  for (const ros::SweepOrder sweep : kSweeps) static_cast<void>(drive(sweep, samples));
  return !samples.empty();
}

}  // namespace

ros::Header header_at(const std::string& frame, std::int64_t stamp_ns) {
  constexpr std::int64_t kLast_ns = 4'294'967'295'999'999'999;
  return ros::header_of(frame, std::clamp<std::int64_t>(stamp_ns, 0, kLast_ns));
}

ros::LaserScan scan_at(std::int64_t stamp_ns, const std::string& frame) {
  ros::LaserScan scan;
  scan.header_(header_at(frame, stamp_ns));
  scan.angle_min_(-1.5F);
  scan.angle_increment_(0.1F);
  scan.angle_max_(1.5F);
  scan.time_increment_(0.001F);
  scan.range_min_(0.1F);
  scan.range_max_(30.0F);
  scan.ranges_(std::vector<float>(31, 2.0F));
  return scan;
}

bool receive_in_bridge(const ros::LaserScan& message) {
  const std::string frame = ros::frame_name(message.header_().frame_id_());
  const std::int64_t stamp_ns = ros::stamp_ns_of(message.header_().stamp_());
  bool taken = false;
  for (const ros::SweepOrder sweep : kSweeps) {
    for (const bool upside_down : {false, true}) {
      // The first scan determines the beams of the others.
      for (const bool is_first : {true, false}) {
        IntakeRun run(sweep, frame, upside_down);
        for (std::int64_t i = -10; i <= 10; ++i) {
          const auto moved = static_cast<double>(i) * 0.1;
          run.add({stamp_ns + i * kTick_ns, {moved, 0.0, moved}, 1.0, 1.0});
        }
        if (!is_first) run.add(scan_at(stamp_ns - 2 * kTick_ns, message.header_().frame_id_()));
        run.add(message);
        run.add(message);
        run.add(scan_at(stamp_ns + 2 * kTick_ns, message.header_().frame_id_()));
        for (const ScanIntake::Leaving& leaving : run.finish()) {
          taken = taken || leaving.scan.stamp_ns == stamp_ns;
        }
      }
    }
  }
  return taken;
}

bool receive_in_bridge(const ros::Odometry& message) {
  const auto sample = ros_bridge::to_sample(message);
  return sample && check_odometry(*sample);
}

bool receive_in_bridge(const ros::TFMessage& message) {
  const bool moves = check_odometry_transforms(message);
  return check_frames(message) || moves;
}

bool receive_in_bridge(const ros::PoseStamped& message) {
  const service::Goal goal = ros_bridge::to_goal(message, {}, geometry::Pose2{1.0, 2.0, 0.5},
                                                 geometry::Pose2{-1.0, 0.5, -2.0});
  check_leaving(service::to_msg(goal, "robot", kRosNow_ns, 0),
                [](const msg::Goal& sent) { return service::from_msg(sent); });
  return true;
}

bool receive_in_bridge(const ros::PoseWithCovarianceStamped& message) {
  const service::LocalizationCommand command = ros_bridge::to_set_pose(message, "map");
  check_leaving(service::to_msg(command, "robot", kRosNow_ns, 0),
                [](const msg::LocalizationCommand& sent) { return service::from_msg(sent); });
  return true;
}

bool receive_in_bridge(const ros::Twist& message) {
  msg::MotionCommand command = ros_bridge::to_motion(message);
  messaging::set_header(command, "robot", kRosNow_ns, 0);
  check_leaving(command, [](const msg::MotionCommand& sent) { return sent.linear_mps(); });
  require(std::isfinite(command.linear_mps()) && std::isfinite(command.angular_radps()),
          "velocities are finite");
  for (const double other : {message.linear_().y_(), message.linear_().z_(),
                             message.angular_().x_(), message.angular_().y_()}) {
    require(std::fabs(other) < 1e-3, "a velocity along x and about z is none besides");
  }
  return true;
}

bool receive_in_bridge(const ros::TwistStamped& message) {
  return receive_in_bridge(message.twist_());
}

}  // namespace topogeo::fuzz
