// Localizes in the map of all scans before a revisit, with the scans from there on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/slam/state_monitor.hpp"

#include "recordings.hpp"

namespace topogeo::bench {

struct RevisitOptions {
  std::size_t most = 12;   ///< revisits per log, spread over it
  std::size_t scans = 40;  ///< of the drive that is localized
};

/// Result at a stop of the second drive.
struct RevisitStop {
  std::size_t scan = 0;
  double path_m = 0.0;  ///< driven from the first scan of the drive
  localization::LocalizationState state = localization::LocalizationState::kSearching;
  geometry::Pose2 T_map_robot;
  geometry::Pose2 T_map_truth;
  double off_m = 0.0;
  double step_ms = 0.0;  ///< CPU time
};

struct RevisitRun {
  std::size_t first_scan = 0;  ///< of the log
  std::size_t map_stops = 0;
  std::vector<RevisitStop> stops;

  static constexpr double kWrong_m = 0.5;
  /// Path driven to the first stop that is tracked at the right place.
  [[nodiscard]] std::optional<double> found_m() const;
  [[nodiscard]] std::size_t tracking() const;
  [[nodiscard]] std::size_t wrong() const;
};

/// Scans at which a revisit begins: within 2 m and 57 degrees of a scan that is 40 or more older.
/// The last of the following `scans` scans, or half of them, are near older ones too.
std::vector<std::size_t> revisits_of(const Recording& recording, const RevisitOptions& options);

/// The map is made of the scans up to 30 before the revisit, with the reference as odometry.
std::vector<RevisitRun> run_revisits(const Recording& recording, const pipeline::Config& config,
                                     const RevisitOptions& options);

}  // namespace topogeo::bench
