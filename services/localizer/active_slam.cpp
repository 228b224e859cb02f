#include "active_slam.hpp"

#include <utility>

#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/pipeline/localization_run.hpp"

namespace topogeo::localizer {

ActiveSlam::ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool) {
  auto session = std::make_unique<localization::MappingSession>(config, pool, &optimizer_);
  session_ = session.get();
  current_ = std::move(session);
}

ActiveSlam::ActiveSlam(const localization::LocalizerConfig& config, localization::MatchPool& pool,
                       std::shared_ptr<const localization::StoredMap> map, Use use,
                       const std::optional<geometry::Pose2>& initial_pose) {
  std::optional<localization::UncertainPose> initial;
  if (initial_pose) initial = {*initial_pose, pipeline::given_pose_covariance()};
  if (use == Use::kContinue) {
    auto session = std::make_unique<localization::MappingSession>(config, pool, &optimizer_,
                                                                  std::move(map), initial);
    session_ = session.get();
    current_ = std::move(session);
    return;
  }
  auto localizer = std::make_unique<localization::MapLocalizer>(config, std::move(map), pool);
  if (initial) localizer->set_pose(initial->T_a_b, initial->covariance);
  map_localizer_ = localizer.get();
  current_ = std::move(localizer);
}

}  // namespace topogeo::localizer
