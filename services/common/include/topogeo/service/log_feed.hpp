// The scans of a log for mapping, with its own odometry or with odometry from the scans, as
// `odometry.source` of the configuration wants it. One process and the gateway choose alike.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/recording/log_reader.hpp"

namespace topogeo::service {

/// Whether a reader needs the odometry of the log.
recording::OdometryUse odometry_use(const pipeline::Config& config);

/// Why the odometry of a log is made from its scans; empty if it is the log's. May read the log.
/// Throws std::runtime_error if it cannot be read.
std::string why_laser_odometry(const recording::LogReader& reader, const pipeline::Config& config);

/// The scans of a log, whose reader must outlive the feed.
pipeline::ScanFeed scan_feed(recording::LogReader& reader, const pipeline::Config& config,
                             bool from_scans);

class LogFeed {
 public:
  /// Takes a reader before its first scan, opened with odometry_use().
  LogFeed(recording::LogReader reader, const pipeline::Config& config);

  /// The next scan; empty at the end of the log.
  std::optional<scan::Scan> next() { return feed_.next(); }
  /// Another feed of the log, from its beginning.
  [[nodiscard]] LogFeed from_start() const;

  [[nodiscard]] const recording::LogReader& reader() const { return *reader_; }
  /// Empty with the log's odometry.
  [[nodiscard]] const std::string& why_laser() const { return why_laser_; }
  /// Null with the log's odometry.
  [[nodiscard]] const localization::LaserOdometryCounts* laser_counts() const {
    return feed_.laser_counts();
  }

 private:
  LogFeed(recording::LogReader reader, const pipeline::Config& config, std::string why_laser);

  pipeline::Config config_;
  std::unique_ptr<recording::LogReader> reader_;  // never null, but in a feed that was moved from
  std::string why_laser_;
  pipeline::ScanFeed feed_;
};

}  // namespace topogeo::service
