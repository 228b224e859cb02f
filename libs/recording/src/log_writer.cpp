#include "topogeo/recording/log_writer.hpp"

#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/recording/laser_scan.hpp"
#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"

#include "message_sink.hpp"

namespace topogeo::recording {

struct LogWriter::Target {
  Target() = default;
  virtual ~Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  virtual void write(const scan::Scan& scan) = 0;
  virtual void write_pose(const scan::Scan& scan, const geometry::Pose2& T_map_robot,
                          const Eigen::Matrix3d& covariance) = 0;
  virtual void close() = 0;
};

namespace {

constexpr const char* kMapFrame = "map";
constexpr const char* kOdomFrame = "odom";
constexpr const char* kRobotFrame = "base_link";
constexpr const char* kLaserFrame = "laser";
constexpr std::string_view kPoseType = "geometry_msgs/msg/PoseWithCovarianceStamped";

class CarmenTarget final : public LogWriter::Target {
 public:
  CarmenTarget(const std::filesystem::path& path, const geometry::Pose2& T_robot_laser)
      : log_(path, T_robot_laser) {}
  void write(const scan::Scan& scan) override { log_.write(scan); }
  void write_pose(const scan::Scan& /*scan*/, const geometry::Pose2& /*T_map_robot*/,
                  const Eigen::Matrix3d& /*covariance*/) override {}
  void close() override { log_.close(); }

 private:
  scan::CarmenLogWriter log_;
};

ros::TransformStamped transform_of(const geometry::Pose2& pose, const char* parent,
                                   const char* child, std::int64_t stamp_ns) {
  ros::TransformStamped stated;
  stated.header_().stamp_(from_stamp_ns(stamp_ns));
  stated.header_().frame_id_(parent);
  stated.child_frame_id_(child);
  stated.transform_().translation_().x_(pose.x_m);
  stated.transform_().translation_().y_(pose.y_m);
  stated.transform_().rotation_(to_quaternion(pose.theta_rad));
  return stated;
}

ros::Pose to_pose(const geometry::Pose2& pose) {
  ros::Pose message;
  message.position_().x_(pose.x_m);
  message.position_().y_(pose.y_m);
  message.orientation_(to_quaternion(pose.theta_rad));
  return message;
}

/// Places of x, y and heading in a row of six.
constexpr std::array<std::size_t, 3> kPlanar = {0, 1, 5};
/// Of height, roll and pitch, which a robot on a floor does not change; not zero, so that the
/// matrix can be inverted.
constexpr double kFlat = 1e-6;

std::array<double, 36> to_covariance(const Eigen::Matrix3d& covariance) {
  std::array<double, 36> out{};
  for (const std::size_t i : {2U, 3U, 4U}) out[i * 6 + i] = kFlat;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      out[kPlanar[i] * 6 + kPlanar[j]] =
          covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
    }
  }
  return out;
}

class RosTarget final : public LogWriter::Target {
 public:
  RosTarget(std::unique_ptr<MessageSink> sink, const geometry::Pose2& T_robot_laser)
      : sink_(std::move(sink)), T_robot_laser_(T_robot_laser) {}

  void write(const scan::Scan& scan) override {
    if (scan.ranges_m.size() < 2) {
      throw std::invalid_argument("ranges_m: expected 2 ranges or more, got " +
                                  std::to_string(scan.ranges_m.size()));
    }
    const std::int64_t stamp_ns = scan.stamp_ns;
    if (!std::exchange(mounting_stated_, true)) {
      put_transform(transform_of(T_robot_laser_, kRobotFrame, kLaserFrame, stamp_ns), "/tf_static",
                    stamp_ns);
    }
    ros::Odometry odometry;
    odometry.header_().stamp_(from_stamp_ns(stamp_ns));
    odometry.header_().frame_id_(kOdomFrame);
    odometry.child_frame_id_(kRobotFrame);
    odometry.pose_().pose_(to_pose(scan.T_odom_robot));
    set_speed(odometry, scan);
    put(odometry, "/odom", kOdometryType, stamp_ns);
    put_transform(transform_of(scan.T_odom_robot, kOdomFrame, kRobotFrame, stamp_ns), "/tf",
                  stamp_ns);
    put(from_scan(scan, kLaserFrame), "/scan", kLaserScanType, stamp_ns);
  }

  void write_pose(const scan::Scan& scan, const geometry::Pose2& T_map_robot,
                  const Eigen::Matrix3d& covariance) override {
    if (sink_->encoding() != Encoding::kCdr) return;
    ros::PoseWithCovarianceStamped pose;
    pose.header_().stamp_(from_stamp_ns(scan.stamp_ns));
    pose.header_().frame_id_(kMapFrame);
    pose.pose_().pose_(to_pose(T_map_robot));
    pose.pose_().covariance_(to_covariance(covariance));
    put(pose, "/pose", kPoseType, scan.stamp_ns);
    put_transform(transform_of(T_map_robot * geometry::inverse(scan.T_odom_robot), kMapFrame,
                               kOdomFrame, scan.stamp_ns),
                  "/tf", scan.stamp_ns);
  }

  void close() override { sink_->close(); }

 private:
  /// From the scan before.
  void set_speed(ros::Odometry& odometry, const scan::Scan& scan) {
    const double step_s = static_cast<double>(scan.stamp_ns - last_ns_) * 1e-9;
    if (last_ns_ != 0 && step_s > 0.0) {
      const geometry::Pose2 step = geometry::between(T_odom_last_, scan.T_odom_robot);
      odometry.twist_().twist_().linear_().x_(step.x_m / step_s);
      odometry.twist_().twist_().angular_().z_(step.theta_rad / step_s);
    }
    last_ns_ = scan.stamp_ns;
    T_odom_last_ = scan.T_odom_robot;
  }

  void put_transform(const ros::TransformStamped& stated, const char* topic,
                     std::int64_t stamp_ns) {
    ros::TfMessage message;
    message.transforms_().push_back(stated);
    put(message, topic, kTfType, stamp_ns);
  }

  template <typename Message>
  void put(const Message& message, const char* topic, std::string_view type,
           std::int64_t stamp_ns) {
    bytes_.clear();
    encode(message, sink_->encoding(), bytes_);
    sink_->write({topic, type, stamp_ns, bytes_});
  }

  std::unique_ptr<MessageSink> sink_;
  geometry::Pose2 T_robot_laser_;
  bool mounting_stated_ = false;
  std::int64_t last_ns_ = 0;
  geometry::Pose2 T_odom_last_;
  std::vector<std::byte> bytes_;
};

std::unique_ptr<LogWriter::Target> make_target(const std::filesystem::path& path,
                                               const geometry::Pose2& T_robot_laser,
                                               const std::string& compression) {
  if (std::unique_ptr<MessageSink> sink = create_sink(path, compression)) {
    return std::make_unique<RosTarget>(std::move(sink), T_robot_laser);
  }
  return std::make_unique<CarmenTarget>(path, T_robot_laser);
}

}  // namespace

LogWriter::LogWriter(const std::filesystem::path& path, const geometry::Pose2& T_robot_laser,
                     const std::string& compression)
    : target_(make_target(path, T_robot_laser, compression)) {}

LogWriter::~LogWriter() = default;
LogWriter::LogWriter(LogWriter&&) noexcept = default;
LogWriter& LogWriter::operator=(LogWriter&&) noexcept = default;

void LogWriter::write(const scan::Scan& scan) {
  target_->write(scan);
}

void LogWriter::write_pose(const scan::Scan& scan, const geometry::Pose2& T_map_robot,
                           const Eigen::Matrix3d& covariance) {
  target_->write_pose(scan, T_map_robot, covariance);
}

void LogWriter::close() {
  target_->close();
}

}  // namespace topogeo::recording
