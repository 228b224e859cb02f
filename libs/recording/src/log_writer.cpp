#include "topogeo/recording/log_writer.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "topogeo/recording/message_source.hpp"
#include "topogeo/recording/ros_codec.hpp"
#include "topogeo/ros_conversions/geometry.hpp"
#include "topogeo/ros_conversions/laser_scan.hpp"
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
  virtual void write_graph(std::int64_t stamp_ns, const ros::GraphDrawing& graph) = 0;
  virtual void write_grid(std::int64_t stamp_ns, const ros::GridPlace& place,
                          std::vector<std::int8_t> cells) = 0;
  [[nodiscard]] virtual bool holds_poses() const = 0;
  virtual void close() = 0;
};

namespace {

constexpr const char* kMapFrame = "map";
constexpr const char* kOdomFrame = "odom";
constexpr const char* kRobotFrame = "base_link";
constexpr const char* kLaserFrame = "laser";
constexpr std::string_view kMarkersType = "visualization_msgs/msg/MarkerArray";
constexpr std::string_view kGridType = "nav_msgs/msg/OccupancyGrid";
constexpr std::string_view kPoseType = "geometry_msgs/msg/PoseWithCovarianceStamped";

class CarmenTarget final : public LogWriter::Target {
 public:
  CarmenTarget(const std::filesystem::path& path, const geometry::Pose2& T_robot_laser)
      : log_(path, T_robot_laser) {}
  void write(const scan::Scan& scan) override { log_.write(scan); }
  void write_pose(const scan::Scan& /*scan*/, const geometry::Pose2& /*T_map_robot*/,
                  const Eigen::Matrix3d& /*covariance*/) override {}
  void write_graph(std::int64_t /*stamp_ns*/, const ros::GraphDrawing& /*graph*/) override {}
  void write_grid(std::int64_t /*stamp_ns*/, const ros::GridPlace& /*place*/,
                  std::vector<std::int8_t> /*cells*/) override {}
  [[nodiscard]] bool holds_poses() const override { return false; }
  void close() override { log_.close(); }

 private:
  scan::CarmenLogWriter log_;
};

/// Beyond the range of such lasers: at least twice the farthest echo.
float range_max_of(const scan::Scan& scan) {
  float farthest_m = 100.0F;
  for (const float range_m : scan.ranges_m) farthest_m = std::max(farthest_m, 2.0F * range_m);
  return farthest_m;
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
      put_transform(ros::transform_of(kRobotFrame, kLaserFrame, T_robot_laser_, stamp_ns),
                    "/tf_static", stamp_ns);
    }
    ros::Odometry odometry;
    odometry.header_(ros::header_of(kOdomFrame, stamp_ns));
    odometry.child_frame_id_(kRobotFrame);
    odometry.pose_().pose_(ros::pose_of(scan.T_odom_robot));
    set_speed(odometry, scan);
    put(odometry, "/odom", kOdometryType, stamp_ns);
    put_transform(ros::transform_of(kOdomFrame, kRobotFrame, scan.T_odom_robot, stamp_ns), "/tf",
                  stamp_ns);
    put(ros::to_laser_scan(scan, kLaserFrame, range_max_of(scan)), "/scan", kLaserScanType,
        stamp_ns);
  }

  void write_pose(const scan::Scan& scan, const geometry::Pose2& T_map_robot,
                  const Eigen::Matrix3d& covariance) override {
    if (!holds_poses()) return;
    put(ros::pose_of(kMapFrame, scan.stamp_ns, T_map_robot, covariance), "/pose", kPoseType,
        scan.stamp_ns);
    put_transform(
        ros::transform_of(kMapFrame, kOdomFrame, T_map_robot * geometry::inverse(scan.T_odom_robot),
                          scan.stamp_ns),
        "/tf", scan.stamp_ns);
  }

  void write_graph(std::int64_t stamp_ns, const ros::GraphDrawing& graph) override {
    if (holds_poses()) {
      put(ros::graph_markers(graph, ros::header_of(kMapFrame, stamp_ns)), "/graph", kMarkersType,
          stamp_ns);
    }
  }

  void write_grid(std::int64_t stamp_ns, const ros::GridPlace& place,
                  std::vector<std::int8_t> cells) override {
    if (!holds_poses()) return;
    put(ros::occupancy_grid(place, std::move(cells), ros::header_of(kMapFrame, stamp_ns)), "/map",
        kGridType, stamp_ns);
  }

  // ROS 1 defines these messages differently, and no reader here supports that.
  [[nodiscard]] bool holds_poses() const override { return sink_->encoding() == Encoding::kCdr; }

  void close() override { sink_->close(); }

 private:
  /// Derived from the previous scan.
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
    ros::TFMessage message;
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

bool is_carmen_name(std::filesystem::path path) {
  const bool compressed = path.extension() == ".gz";
  if (compressed) path.replace_extension();
  const std::string ending = path.extension().string();
  return ending == ".clf" || ending == ".log" || (compressed && ending.empty());
}

std::unique_ptr<LogWriter::Target> make_target(const std::filesystem::path& path,
                                               const geometry::Pose2& T_robot_laser,
                                               const std::string& compression) {
  if (const std::string fault = check_log_name(path); !fault.empty()) {
    throw std::invalid_argument(fault);
  }
  if (std::unique_ptr<MessageSink> sink = create_sink(path, compression)) {
    return std::make_unique<RosTarget>(std::move(sink), T_robot_laser);
  }
  return std::make_unique<CarmenTarget>(path, T_robot_laser);
}

}  // namespace

std::string check_log_name(const std::filesystem::path& path) {
  if (is_recording_name(path) || is_carmen_name(path)) return {};
  return path.string() + ": expected a name with the ending " + kWrittenLogs;
}

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

void LogWriter::write_graph(std::int64_t stamp_ns, const ros::GraphDrawing& graph) {
  target_->write_graph(stamp_ns, graph);
}

void LogWriter::write_grid(std::int64_t stamp_ns, const ros::GridPlace& place,
                           std::vector<std::int8_t> cells) {
  target_->write_grid(stamp_ns, place, std::move(cells));
}

bool LogWriter::holds_poses() const {
  return target_->holds_poses();
}

void LogWriter::close() {
  target_->close();
}

}  // namespace topogeo::recording
