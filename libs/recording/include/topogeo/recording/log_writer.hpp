// Writes the scans and poses of a robot as a log of any format: a CARMEN text log, or a recording
// that ROS, Foxglove and our own reader can read.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/ros_conversions/grid.hpp"
#include "topogeo/ros_conversions/markers.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::recording {

/// Endings of the names of logs to write, for help texts and messages.
inline constexpr const char* kWrittenLogs =
    ".mcap, .db3, .bag, .clf or .log (CARMEN; also .clf.gz, .log.gz, .gz), or none or a slash "
    "(new folder of rosbag2)";

/// The fault of the name of a log to write, with the endings that are expected; empty if LogWriter
/// knows its format.
std::string check_log_name(const std::filesystem::path& path);

class LogWriter {
 public:
  /// Creates or replaces the file, whose name selects the format: .mcap, .db3, .bag; .clf and .log
  /// for a CARMEN log, which .gz compresses; without an ending or with a trailing slash a new
  /// folder of rosbag2. `T_robot_laser`: mounting of the laser, stated in the log. `compression`:
  /// see ConvertOptions. Throws std::runtime_error if the file cannot be written,
  /// std::invalid_argument for another ending and for a compression that the format does not have.
  explicit LogWriter(const std::filesystem::path& path, const geometry::Pose2& T_robot_laser = {},
                     const std::string& compression = "zstd");

  /// Closes without reporting errors; close() reports them.
  ~LogWriter();
  LogWriter(LogWriter&&) noexcept;
  LogWriter& operator=(LogWriter&&) noexcept;
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// Appends a scan with its odometry; in a recording /scan, /odom and odom -> base_link on /tf.
  /// Throws std::invalid_argument for a scan that no log can hold (see scan::CarmenLogWriter),
  /// std::runtime_error if writing fails.
  void write(const scan::Scan& scan);

  /// Appends a pose of the robot in the map at the time of a scan, with its covariance over x, y,
  /// heading in the map frame: /pose, and map -> odom on /tf. Only .mcap and .db3 store it; other
  /// formats ignore it. Throws std::runtime_error if writing fails.
  void write_pose(const scan::Scan& scan, const geometry::Pose2& T_map_robot,
                  const Eigen::Matrix3d& covariance);

  /// Appends the present graph, which replaces earlier ones: markers on /graph. Formats and errors
  /// as for write_pose().
  void write_graph(std::int64_t stamp_ns, const ros::GraphDrawing& graph);

  /// Appends the present occupancy grid of the map: /map. `cells`: see ros::occupancy_grid().
  /// Formats and errors as for write_pose().
  void write_grid(std::int64_t stamp_ns, const ros::GridPlace& place,
                  std::vector<std::int8_t> cells);

  /// Whether the file stores the data of write_pose(), write_graph() and write_grid().
  [[nodiscard]] bool holds_poses() const;

  /// Flushes and closes. Throws std::runtime_error if that fails.
  void close();

  struct Target;

 private:
  std::unique_ptr<Target> target_;
};

}  // namespace topogeo::recording
