// Converts scan, odometry and frames of ROS to our scans and odometry: the counterpart of the
// sensor gateway for devices.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/matching/laser_odometry.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/sensor.h"
#include "topogeo/msg/stream.h"

#include "ros_side.hpp"
#include "scan_intake.hpp"

namespace topogeo::ros_bridge {

/// Lives in the loop of its service.
class SensorInput {
 public:
  explicit SensorInput(RosSide& ros);
  SensorInput(const SensorInput&) = delete;
  SensorInput& operator=(const SensorInput&) = delete;
  ~SensorInput();

  /// Ends the stream, so that scan readers may finish. Call it once, at the end.
  void finish();

  /// Called for each tf transform outside of the robot's own frames: parent, child, stamp.
  std::function<void(const std::string&, const std::string&, std::int64_t)> on_foreign_transform;

  /// Called for each published odometry: stamp, epoch, T_odom_robot.
  std::function<void(std::int64_t, std::uint64_t, const geometry::Pose2&)> on_reading;

  /// Mounting of the laser, once a scan with a known, usable mounting has arrived.
  [[nodiscard]] const ScanIntake& intake() const { return intake_; }

 private:
  void on_odometry(const ros::Odometry& message, const messaging::SampleInfo& info);
  void on_transforms(const ros::TFMessage& message, const messaging::SampleInfo& info,
                     bool are_static);
  void on_odometry_transform(const ros::TransformStamped& message,
                             const messaging::SampleInfo& info);
  void on_scan(const ros::LaserScan& message, const messaging::SampleInfo& info);
  void add(const geometry::OdometrySample& sample);
  void release(std::int64_t now_ns);
  /// Odometry from the scans places what has left the intake.
  void follow(ScanIntake::Leaving leaving);
  void publish(const ScanIntake::Leaving& leaving);
  void publish_state();
  [[nodiscard]] bool is_from_scans() const;
  [[nodiscard]] std::uint64_t epoch() const { return epoch_salt_ + intake_.epochs(); }
  [[nodiscard]] std::uint64_t epoch_of(const scan::Scan& scan) const;
  /// Scans to be published in this epoch of the intake, those before included.
  [[nodiscard]] std::uint64_t numbered() const;

  RosSide& ros_;
  ScanIntake intake_;
  std::uint64_t epoch_salt_;
  std::string robot_frame_;
  SoleWriter scan_writer_;
  SoleWriter odometry_writer_;
  std::optional<geometry::OdometrySample> last_transform_;
  messaging::Writer<msg::Scan> scans_;
  messaging::Writer<msg::Odometry> odometry_;
  messaging::Writer<msg::StreamEnd> stream_end_;
  std::optional<localization::LaserOdometry> laser_odometry_;
  std::uint64_t laser_epochs_ = 0;   // breaks of its track
  std::uint64_t intake_epochs_ = 0;  // in which it began
  std::uint64_t scans_placed_ = 0;   // in this epoch of the intake
  std::uint64_t odometry_sent_ = 0;
  std::uint64_t scans_sent_ = 0;
  std::int64_t last_scan_ns_ = 0;
  std::int64_t latency_ns_ = 0;
  std::uint64_t scans_at_state_ = 0;
  std::string published_;
  std::uint64_t release_timer_ = 0;
  std::uint64_t state_timer_ = 0;
};

}  // namespace topogeo::ros_bridge
