#include "active_slam.hpp"

#include <stdexcept>
#include <utility>

#include "topogeo/localization/localizer.hpp"
#include "topogeo/pipeline/localization_run.hpp"

namespace topogeo::localizer {

ActiveSlam::ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool)
    : config_(config), pool_(pool), current_(localization::make_slam(config, pool, &optimizer_)) {}

ActiveSlam::ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool,
                       std::shared_ptr<const localization::StoredMap> map,
                       const std::optional<geometry::Pose2>& initial_pose)
    : config_(config), pool_(pool) {
  auto localizer = std::make_unique<localization::MapLocalizer>(config, std::move(map), pool);
  if (initial_pose) localizer->set_pose(*initial_pose, pipeline::given_pose_covariance());
  map_localizer_ = localizer.get();
  current_ = std::move(localizer);
}

void ActiveSlam::freeze(std::span<const MapPointer> maps) {
  if (map_localizer_ != nullptr) throw std::logic_error("the map is frozen already");
  auto stored = std::make_shared<localization::StoredMap>();
  stored->trajectory = current_->trajectory();
  for (const MapPointer& map : maps) stored->maps.push_back(*map);
  const topomap::StopPose last = stored->trajectory.stops.back();
  auto localizer = std::make_unique<localization::MapLocalizer>(
      config_, stored, pool_, static_cast<std::uint32_t>(maps.size()));
  localizer->start_after(*maps.back(), last.T_map_robot);
  map_localizer_ = localizer.get();
  frozen_ = std::exchange(current_, std::move(localizer));
}

}  // namespace topogeo::localizer
