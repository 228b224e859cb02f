// The scans of a log for mapping, with its own odometry or with odometry from the scans.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/matching/laser_odometry.hpp"
#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::pipeline {

/// Returns the next scan of a log, in order of time; empty at its end.
using NextScan = std::function<std::optional<scan::Scan>()>;

/// Odometry from the scans of the laser of a configuration.
localization::LaserOdometry laser_odometry(const LocalMapperConfig& config);

class ScanFeed {
 public:
  /// With the log's odometry.
  explicit ScanFeed(NextScan next) : next_(std::move(next)) {}
  /// With odometry from the scans: those that it cannot place are left out.
  ScanFeed(NextScan next, localization::LaserOdometry odometry)
      : next_(std::move(next)), odometry_(std::move(odometry)) {}

  /// The next scan; empty at the end of the log.
  std::optional<scan::Scan> next();

  /// The counts of odometry from the scans read so far; null with the log's.
  [[nodiscard]] const localization::LaserOdometryCounts* laser_counts() const {
    return odometry_ ? &odometry_->counts() : nullptr;
  }

 private:
  NextScan next_;
  std::optional<localization::LaserOdometry> odometry_;
  std::deque<scan::Scan> ready_;
  bool ended_ = false;
};

/// Whether the odometry of a log stays at one pose (1 cm, 0.01 rad). Reads the log up to the first
/// scan with another pose.
bool odometry_stands(const NextScan& next);

/// Whether the laser moves by half a metre or 20 degrees, by its scans alone. Reads the log up to
/// that scan.
bool laser_moves(const NextScan& next, localization::LaserOdometry odometry);

/// Distance between successive scans of a moving laser, m: the median; 0 if it never moved.
double usual_step_m(const localization::LaserOdometryCounts& counts);

/// Why the scans of a log are too far apart for odometry from them; empty if they are not.
std::string too_sparse(const localization::LaserOdometryCounts& counts);

}  // namespace topogeo::pipeline
