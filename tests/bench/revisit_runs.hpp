// Localizes in the map of all that was driven before a revisit, with what was seen from there on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/pipeline/config.hpp"

#include "recordings.hpp"

namespace topogeo::bench {

struct RevisitOptions {
  std::size_t most = 12;   ///< revisits of a log that are run, spread over it
  std::size_t scans = 40;  ///< of the drive that is localized
};

/// What was reported at a stop of the second drive.
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
  /// Path driven to the first stop that is tracked where the robot is.
  [[nodiscard]] std::optional<double> found_m() const;
  [[nodiscard]] std::size_t tracking() const;
  [[nodiscard]] std::size_t wrong() const;
};

/// Scans at which a revisit begins: within 2 m and 57 degrees of one 40 or more older, and so is
/// the last of the `scans` that follow, or half of them.
std::vector<std::size_t> revisits_of(const Recording& recording, const RevisitOptions& options);

/// The map is made of the scans up to 30 before the revisit, with the reference as odometry.
std::vector<RevisitRun> run_revisits(const Recording& recording, const pipeline::Config& config,
                                     const RevisitOptions& options);

}  // namespace topogeo::bench
