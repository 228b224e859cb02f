// One reader for all log formats: CARMEN text logs, and recordings of ROS (see message_source.hpp).
// All return the same scans, so that a drive gives the same map in each format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/recording/survey.hpp"
#include "topogeo/scan/carmen_log_check.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/no_return.hpp"

namespace topogeo::recording {

/// Formats that `--log` accepts, for help texts.
inline constexpr const char* kLogFormats =
    "CARMEN log (plain or gzip), or recording of ROS: .db3, .mcap, .bag, folder of rosbag2";

class LogReader {
 public:
  /// Opens the log and reads up to its first usable scan. Throws like scan::CarmenLogReader and
  /// survey().
  explicit LogReader(const std::filesystem::path& path, const scan::CarmenLogOptions& options = {},
                     const TopicChoice& topics = {});
  ~LogReader();
  LogReader(LogReader&&) noexcept;
  LogReader& operator=(LogReader&&) noexcept;
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// Another reader of the log, from its beginning, that need not search the whole log again.
  [[nodiscard]] LogReader from_start() const;

  /// Like scan::CarmenLogReader::next().
  std::optional<scan::Scan> next();

  /// In a recording, `lines` counts its messages of all kinds that were read, `laser_lines` its
  /// scans.
  [[nodiscard]] const scan::CarmenLogStatistics& statistics() const;

  /// At least the number of usable scans. Reads a CARMEN log once more.
  [[nodiscard]] std::uint64_t scan_count() const;

  /// Share of the log read so far, in [0, 1].
  [[nodiscard]] double fraction_read() const;

  /// False if the log is a recording without usable odometry, or TopicChoice ignores it.
  [[nodiscard]] bool has_odometry() const;
  /// Odometry of a recording at a time of its clock.
  struct OdometryPose {
    geometry::Pose2 T_odom_robot;
    std::uint64_t epoch = 0;  ///< from 0; poses of different epochs are unrelated
  };
  /// Interpolated; empty where none is near, and for a CARMEN log, whose scans have their odometry
  /// beside them.
  [[nodiscard]] std::optional<OdometryPose> odometry_at(std::int64_t stamp_ns) const;
  /// Why none of the odometry messages of a recording is usable; empty if some are, if there are
  /// none, or if TopicChoice requires odometry.
  [[nodiscard]] const std::string& odometry_fault() const;

  /// The range that this log has in place of an echo, found by reading the whole log; its scans
  /// have no return there. Empty if there is none below the range limit of the options.
  [[nodiscard]] const std::optional<scan::NoReturn>& no_return() const;

  struct Source;
  struct Opened;

 private:
  explicit LogReader(std::shared_ptr<const Opened> opened);

  std::shared_ptr<const Opened> opened_;  // never null, but in a reader that was moved from
  std::unique_ptr<Source> source_;
};

struct LogMounting {
  std::optional<geometry::Pose2> T_robot_laser;  ///< empty if neither the log nor the choice does
  std::vector<std::string> notes;                ///< of Survey; none for a CARMEN log
};
/// Throws std::runtime_error if the log cannot be opened.
LogMounting mounting_in_log(const std::filesystem::path& path, const TopicChoice& topics = {});

/// Like scan::check_carmen_log. In a recording, messages count as lines, and a fault has the number
/// of its scan among those of the topic, from 1.
scan::LogCheck check_log(const std::filesystem::path& path,
                         const scan::LogCheckOptions& options = {}, const TopicChoice& topics = {});

}  // namespace topogeo::recording
