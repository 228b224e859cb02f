#include "topogeo/pipeline/mapping_run.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

namespace topogeo::pipeline {

using localization::MapToUse;

MappingRun::MappingRun(const Config& config, std::string robot_id)
    : config_(config),
      robot_id_(std::move(robot_id)),
      local_mapper_(config.local_mapper, robot_id_),
      slam_(config.localizer, pool_) {}

MappingRun::MappingRun(const Config& config, std::string robot_id,
                       std::shared_ptr<const storage::MapDocument> map,
                       const std::optional<geometry::Pose2>& initial_pose)
    : config_(config),
      robot_id_(std::move(robot_id)),
      // A log that is added to its own map becomes another session.
      local_mapper_(config.local_mapper, robot_id_, storage::identified(*map).map_id),
      continued_(std::move(map)),
      slam_(config.localizer, pool_, nullptr,
            {stored_map(*continued_), MapToUse::Use::kExtendMap, initial_pose}) {}

MappingRun::MappingRun(const Config& config, std::string robot_id,
                       std::shared_ptr<const localization::StoredMap> map,
                       const std::optional<geometry::Pose2>& initial_pose)
    : config_(config),
      robot_id_(std::move(robot_id)),
      local_mapper_(config.local_mapper, robot_id_),
      slam_(config.localizer, pool_, nullptr,
            {std::move(map), MapToUse::Use::kLocalize, initial_pose}) {}

void MappingRun::add(const scan::Scan& scan) {
  std::optional<topomap::LocalMap> map;
  {
    const auto scope = times_.measure("local_mapper");
    map = local_mapper_.add(scan);
  }
  if (map) add_stop(std::move(*map));
}

void MappingRun::add_stop(topomap::LocalMap map) {
  const auto scope = times_.measure("localizer");
  if (session() == nullptr) local_maps_.push_back(map);
  const auto measured = std::make_shared<const topomap::LocalMap>(std::move(map));
  const auto chained = odometry_.add(measured);
  if (chained != measured) measured_[measured->stop] = measured;
  slam_->add(chained);
}

storage::MapDocument MappingRun::finish() {
  if (std::optional<topomap::LocalMap> map = local_mapper_.finish()) add_stop(std::move(*map));
  {
    const auto scope = times_.measure("localizer");
    slam_->finish();
  }
  if (continued_ && session()->added_stops() == 0) return *continued_;
  storage::MapDocument document;
  document.robot_id = robot_id_;
  document.seed = config_.localizer.seed;
  document.local_maps = std::move(local_maps_);
  if (session() != nullptr) {
    for (const auto& map : session()->maps()) document.local_maps.push_back(*map);
    for (topomap::LocalMap& map : document.local_maps) {
      const auto measured = measured_.find(map.stop);
      if (measured == measured_.end()) continue;
      map.T_odom_robot = measured->second->T_odom_robot;
      map.track = measured->second->track;
    }
  }
  document.trajectory = slam_->trajectory();
  document.loop_closures = slam_->loop_closures();
  document.edges = map_edges(slam_->edges());
  if (continued_) {
    document.drawing = continued_->drawing;
    document.rooms = continued_->rooms;
    document.map_id = continued_->map_id;
  } else if (!document.local_maps.empty()) {
    document.map_id = storage::map_id_of(document.local_maps.front().stop.session);
  }
  const auto scope = times_.measure("map_store");
  document.global_map = fuse(config_.global_map, document.local_maps, document.trajectory);
  remember_rooms(document, config_.hybrid_map);
  return document;
}

topomap::GlobalMap fuse(const topomap::GlobalMapConfig& config,
                        const std::vector<topomap::LocalMap>& local_maps,
                        const topomap::Trajectory& trajectory) {
  topomap::GlobalMapBuilder builder(config);
  const auto known = [](const topomap::StopPose& stop) { return stop.located; };
  if (std::all_of(trajectory.stops.begin(), trajectory.stops.end(), known)) {
    builder.rebuild(local_maps, trajectory.stops);
    return builder.snapshot(trajectory.version);
  }
  for (std::size_t i = 0; i < trajectory.stops.size(); ++i) {
    const topomap::StopPose& stop = trajectory.stops[i];
    if (stop.located) builder.integrate(local_maps.at(i), stop);
  }
  return builder.snapshot(trajectory.version);
}

}  // namespace topogeo::pipeline
