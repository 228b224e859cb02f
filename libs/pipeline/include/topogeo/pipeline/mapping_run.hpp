// Makes a map from scans in one process: the work of all services together, without DDS.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/scan/scan.hpp"
#include "topogeo/session/odometry_chain.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/storage/map_document.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::pipeline {

class MappingRun {
 public:
  MappingRun(const Config& config, std::string robot_id);
  /// Localizes in a finished map instead; the document then contains the stops of this drive, with
  /// poses in the frame of that map. Without an initial pose it searches. Throws like MapTracker.
  MappingRun(const Config& config, std::string robot_id,
             std::shared_ptr<const localization::StoredMap> map,
             const std::optional<geometry::Pose2>& initial_pose);

  /// Continues a map: its stops come first in the document, which is the unchanged map if the
  /// robot's pose in it is not found. Without an initial pose it searches. Throws like
  /// MappingSession.
  MappingRun(const Config& config, std::string robot_id,
             std::shared_ptr<const storage::MapDocument> map,
             const std::optional<geometry::Pose2>& initial_pose);

  /// Takes the next scan, in time order.
  void add(const scan::Scan& scan);

  /// Ends the log and returns the map. Call it once, after the last scan.
  storage::MapDocument finish();

  [[nodiscard]] localization::SlamCounts match_counts() const { return slam_->counts(); }
  /// Null if it localizes in a finished map.
  [[nodiscard]] const localization::MappingSession* session() const {
    return slam_.mapping_session();
  }
  /// Null unless it localizes in a finished map.
  [[nodiscard]] const localization::MapTracker* map_tracker() const {
    return session() == nullptr ? slam_.map_tracker() : nullptr;
  }
  [[nodiscard]] const std::vector<localization::LoopDecision>& loop_decisions() const {
    return slam_->loop_decisions();
  }
  /// "local_mapper", "localizer" and "map_store", named after the corresponding services.
  [[nodiscard]] const std::vector<support::StageTime>& stages() const { return times_.stages(); }

 private:
  void add_stop(topomap::LocalMap map);

  Config config_;
  std::string robot_id_;
  localization::InProcessPool pool_;
  LocalMapper local_mapper_;
  localization::OdometryChain odometry_;
  /// Stops whose odometry epoch is not the first one, with the odometry as it was measured.
  std::map<topomap::StopId, std::shared_ptr<const topomap::LocalMap>> measured_;
  std::shared_ptr<const storage::MapDocument> continued_;
  localization::SlamSession slam_;
  std::vector<topomap::LocalMap> local_maps_;  // of a drive in a finished map
  support::StageTimes times_;
};

/// The global map of local maps at their poses, without stops that are not located: the content of
/// map_store.
topomap::GlobalMap fuse(const topomap::GlobalMapConfig& config,
                        const std::vector<topomap::LocalMap>& local_maps,
                        const topomap::Trajectory& trajectory);

}  // namespace topogeo::pipeline
