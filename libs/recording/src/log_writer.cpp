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
  virtual void write_graph(std::int64_t stamp_ns, const GraphDrawing& graph) = 0;
  [[nodiscard]] virtual bool holds_poses() const = 0;
  virtual void close() = 0;
};

namespace {

constexpr const char* kMapFrame = "map";
constexpr const char* kOdomFrame = "odom";
constexpr const char* kRobotFrame = "base_link";
constexpr const char* kLaserFrame = "laser";
constexpr std::string_view kMarkersType = "visualization_msgs/msg/MarkerArray";
constexpr std::string_view kPoseType = "geometry_msgs/msg/PoseWithCovarianceStamped";

class CarmenTarget final : public LogWriter::Target {
 public:
  CarmenTarget(const std::filesystem::path& path, const geometry::Pose2& T_robot_laser)
      : log_(path, T_robot_laser) {}
  void write(const scan::Scan& scan) override { log_.write(scan); }
  void write_pose(const scan::Scan& /*scan*/, const geometry::Pose2& /*T_map_robot*/,
                  const Eigen::Matrix3d& /*covariance*/) override {}
  void write_graph(std::int64_t /*stamp_ns*/, const GraphDrawing& /*graph*/) override {}
  [[nodiscard]] bool holds_poses() const override { return false; }
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

ros::Point to_point(const Eigen::Vector2d& point_m) {
  ros::Point point;
  point.x_(point_m.x());
  point.y_(point_m.y());
  return point;
}

enum class MarkerType : std::int32_t { kLineStrip = 4, kSphereList = 7 };
enum class MarkerAction : std::int32_t { kAdd = 0, kDeleteAll = 3 };

ros::Marker graph_marker(const char* kind, std::size_t id, MarkerType type,
                         const std::vector<Eigen::Vector2d>& points, double size_m,
                         std::int64_t stamp_ns) {
  ros::Marker marker;
  marker.header_().stamp_(from_stamp_ns(stamp_ns));
  marker.header_().frame_id_(kMapFrame);
  marker.ns_(kind);
  marker.id_(static_cast<std::int32_t>(id));
  marker.type_(static_cast<std::int32_t>(type));
  marker.action_(static_cast<std::int32_t>(MarkerAction::kAdd));
  marker.pose_().orientation_().w_(1.0);
  marker.scale_().x_(size_m);
  marker.scale_().y_(size_m);
  marker.scale_().z_(size_m);
  marker.color_().g_(0.45F);
  marker.color_().b_(0.7F);
  marker.color_().a_(1.0F);
  for (const Eigen::Vector2d& point_m : points) marker.points_().push_back(to_point(point_m));
  return marker;
}

/// The branches as lines and the nodes as spheres, after what clears those before.
ros::MarkerArray graph_markers(const GraphDrawing& graph, std::int64_t stamp_ns) {
  constexpr double kBranch_m = 0.05;
  constexpr double kNode_m = 0.2;
  ros::MarkerArray array;
  array.markers_().push_back(graph_marker("", 0, MarkerType::kSphereList, {}, kNode_m, stamp_ns));
  array.markers_().back().action_(static_cast<std::int32_t>(MarkerAction::kDeleteAll));
  for (std::size_t i = 0; i < graph.branches.size(); ++i) {
    array.markers_().push_back(graph_marker("branches", i, MarkerType::kLineStrip,
                                            graph.branches[i], kBranch_m, stamp_ns));
  }
  array.markers_().push_back(
      graph_marker("nodes", 0, MarkerType::kSphereList, graph.nodes, kNode_m, stamp_ns));
  return array;
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
    if (!holds_poses()) return;
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

  void write_graph(std::int64_t stamp_ns, const GraphDrawing& graph) override {
    if (holds_poses()) put(graph_markers(graph, stamp_ns), "/graph", kMarkersType, stamp_ns);
  }

  // ROS 1 has other definitions of these messages, which nobody here reads.
  [[nodiscard]] bool holds_poses() const override { return sink_->encoding() == Encoding::kCdr; }

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

void LogWriter::write_graph(std::int64_t stamp_ns, const GraphDrawing& graph) {
  target_->write_graph(stamp_ns, graph);
}

bool LogWriter::holds_poses() const {
  return target_->holds_poses();
}

void LogWriter::close() {
  target_->close();
}

}  // namespace topogeo::recording
