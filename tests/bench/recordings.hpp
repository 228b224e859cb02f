// Scans with a true pose, for programs that measure errors: simulated logs and recorded ones with
// their reference trajectory.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::bench {

struct Recording {
  std::string name;
  std::vector<scan::Scan> scans;  ///< all of the log, in time order
  /// One a scan; empty where the reference trajectory has no pose within a millisecond of it.
  std::vector<std::optional<geometry::Pose2>> T_world_robot;
};

/// The default drive through a world file. Throws std::runtime_error naming the file.
Recording simulated(const std::string& world_file);

/// A CARMEN log with its reference trajectory (TUM). Throws std::runtime_error naming the file.
Recording recorded(const std::string& log_file, const std::string& reference_file,
                   const scan::CarmenLogOptions& options);

/// The first scan and every `every`-th after it, named NAME/N; `every` > 0.
Recording thinned(const Recording& recording, std::size_t every);

}  // namespace topogeo::bench
