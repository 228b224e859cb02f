// Makes local maps from scans: chooses the stops, tracks the robot between them and makes the local
// map of each stop (docs/algorithms.md, "Local Voronoi diagram", "Local topo-geometric map" and
// "Scan tracking").
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/matching/scan_tracker.hpp"
#include "topogeo/pipeline/bounded_track.hpp"
#include "topogeo/pipeline/carried_watch.hpp"
#include "topogeo/pipeline/local_mapper_config.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

namespace topogeo::pipeline {

class LocalMapper {
 public:
  /// The number of its session follows from the robot, the first scan and `session_salt`: a replay
  /// passes 0 to get the same one each time, a robot something random. Throws std::invalid_argument
  /// if a field of the configuration is outside its range.
  LocalMapper(const LocalMapperConfig& config, std::string robot_id,
              std::uint64_t session_salt = 0);

  /// Sets the `session_salt` of the constructor for sessions that begin from now on.
  void set_session_salt(std::uint64_t salt) { session_salt_ = salt; }

  /// Continues the session of its last stop, as if there had been no scan since. Call before the
  /// first scan.
  void resume(const topomap::LocalMap& last_stop);

  /// Takes the next scan, in time order; returns a local map if the robot is at a stop. The first
  /// scan is a stop, and so is the first of each odometry epoch: if it can be placed relative to
  /// the last stop it belongs to that session, otherwise it begins another one. A robot that was
  /// carried away begins another session, too.
  std::optional<topomap::LocalMap> add(const scan::Scan& scan);

  /// The last scan, placed relative to the last stop; null if it was that stop.
  [[nodiscard]] const topomap::TrackedScan* last_tracked() const {
    return track_.empty() ? nullptr : &track_.last();
  }

  /// Call after the first scan or resume().
  [[nodiscard]] topomap::StopId last_stop() const { return {next_.session, next_.number - 1}; }

  /// At the end of a log: makes the last scan a stop, unless it was one, so that the scans since
  /// the previous stop are not lost.
  std::optional<topomap::LocalMap> finish();

 private:
  /// T_stop_robot of a scan whose odometry has restarted.
  [[nodiscard]] std::optional<geometry::Pose2> find_again(const scan::Scan& scan) const;
  /// Whether a tracked scan becomes a stop; hardly one where the robot may have been carried.
  [[nodiscard]] bool is_stop(const localization::TrackedPose& pose, bool maybe_carried) const;
  topomap::LocalMap begin_session(const scan::Scan& scan);
  topomap::LocalMap make_stop(const scan::Scan& scan, const geometry::Pose2& T_stop_robot);
  [[nodiscard]] std::vector<topomap::ScanPoint> points_of(const scan::Scan& scan) const;

  LocalMapperConfig config_;
  std::string robot_id_;
  localization::ScanTracker tracker_;
  CarriedWatch carried_;
  voronoi::LocalVoronoi diagram_maker_;
  voronoi::LocalVoronoiDiagram diagram_;
  topomap::LocalMapBuilder map_builder_;
  std::uint64_t session_salt_ = 0;
  topomap::StopId next_;
  std::uint64_t odometry_epoch_ = 0;  // of the last scan
  BoundedTrack track_;                // since the last stop
  std::optional<scan::Scan> last_;    // the last scan, if it was no stop
};

}  // namespace topogeo::pipeline
