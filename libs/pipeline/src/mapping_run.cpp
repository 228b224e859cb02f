#include "topogeo/pipeline/mapping_run.hpp"

#include <memory>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

namespace topogeo::pipeline {

MappingRun::MappingRun(const Config& config, std::string robot_id)
    : config_(config),
      robot_id_(std::move(robot_id)),
      local_mapper_(config.local_mapper, robot_id_),
      localizer_(localization::make_slam(config.localizer, pool_)) {}

MappingRun::MappingRun(const Config& config, std::string robot_id,
                       std::shared_ptr<const localization::StoredMap> map,
                       const std::optional<geometry::Pose2>& initial_pose)
    : config_(config),
      robot_id_(std::move(robot_id)),
      local_mapper_(config.local_mapper, robot_id_) {
  auto localizer =
      std::make_unique<localization::MapLocalizer>(config.localizer, std::move(map), pool_);
  if (initial_pose) localizer->set_pose(*initial_pose, given_pose_covariance());
  map_localizer_ = localizer.get();
  localizer_ = std::move(localizer);
}

void MappingRun::add(const scan::Scan& scan) {
  std::optional<topomap::LocalMap> map;
  {
    const auto scope = times_.measure("local_mapper");
    map = local_mapper_.add(scan);
  }
  if (map) localize(std::move(*map));
}

void MappingRun::localize(topomap::LocalMap map) {
  const auto scope = times_.measure("localizer");
  local_maps_.push_back(map);
  localizer_->add(std::make_shared<const topomap::LocalMap>(std::move(map)));
}

storage::MapDocument MappingRun::finish() {
  if (std::optional<topomap::LocalMap> map = local_mapper_.finish()) localize(std::move(*map));
  {
    const auto scope = times_.measure("localizer");
    localizer_->finish();
  }
  storage::MapDocument document;
  document.robot_id = robot_id_;
  document.seed = config_.localizer.seed;
  document.local_maps = std::move(local_maps_);
  document.trajectory = localizer_->trajectory();
  document.loop_closures = localizer_->loop_closures();
  const auto scope = times_.measure("map_store");
  document.global_map = fuse(config_.global_map, document.local_maps, document.trajectory);
  return document;
}

topomap::GlobalMap fuse(const topomap::GlobalMapConfig& config,
                        const std::vector<topomap::LocalMap>& local_maps,
                        const topomap::Trajectory& trajectory) {
  topomap::GlobalMapBuilder builder(config);
  builder.rebuild(local_maps, trajectory.stops);
  return builder.snapshot(trajectory.version);
}

}  // namespace topogeo::pipeline
