// From scans to local maps: chooses the stops, follows the robot between them and makes the local
// map of each stop (docs/algorithms.md, "Local Voronoi diagram", "Local topo-geometric map" and
// "Scan tracking").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/localization/tracking/scan_tracker.hpp"
#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::pipeline {

class LocalMapper {
 public:
  /// Throws std::invalid_argument when a field of the configuration is outside its range.
  LocalMapper(const LocalMapperConfig& config, std::string robot_id);

  /// Takes the next scan, in time order; gives a local map when the robot is at a stop. The first
  /// scan is one.
  std::optional<topomap::LocalMap> add(const scan::Scan& scan);

  /// The last scan, placed against the last stop; null when that was the stop.
  [[nodiscard]] const topomap::TrackedScan* last_tracked() const {
    return track_.empty() ? nullptr : &track_.back();
  }

  /// At the end of a log: makes a stop of the last scan, if it was none, so that the scans since
  /// the stop before are not lost.
  std::optional<topomap::LocalMap> finish();

 private:
  topomap::LocalMap make_stop(const scan::Scan& scan, const geometry::Pose2& T_stop_robot);
  [[nodiscard]] std::vector<topomap::ScanPoint> points_of(const scan::Scan& scan) const;

  LocalMapperConfig config_;
  std::string robot_id_;
  localization::ScanTracker tracker_;
  voronoi::LocalVoronoi diagram_maker_;
  voronoi::LocalVoronoiDiagram diagram_;
  topomap::LocalMapBuilder map_builder_;
  std::uint32_t next_id_ = 0;
  std::vector<topomap::TrackedScan> track_;  // since the last stop
  std::optional<scan::Scan> last_;           // the last scan, if it was no stop
};

}  // namespace topogeo::pipeline
