#include "topogeo/session/slam_session.hpp"

#include <numbers>
#include <utility>

namespace topogeo::localization {

Eigen::Matrix3d given_pose_covariance() {
  constexpr double kSigma_m = 0.3;  // accuracy of a person who points at a plan
  constexpr double kSigma_rad = 10.0 * std::numbers::pi / 180.0;
  return Eigen::Vector3d(kSigma_m * kSigma_m, kSigma_m * kSigma_m, kSigma_rad * kSigma_rad)
      .asDiagonal();
}

SlamSession::SlamSession(const LocalizerConfig& config, MatchPool& pool,
                         GraphOptimizer* optimizer) {
  auto session = std::make_unique<MappingSession>(config, pool, optimizer);
  mapping_session_ = session.get();
  slam_ = std::move(session);
}

SlamSession::SlamSession(const LocalizerConfig& config, MatchPool& pool, GraphOptimizer* optimizer,
                         const MapToUse& stored) {
  std::optional<UncertainPose> start;
  if (stored.T_map_start) start = {*stored.T_map_start, given_pose_covariance()};
  if (stored.use != MapToUse::Use::kLocalize) {
    auto session = std::make_unique<MappingSession>(config, pool, optimizer, stored.map, start);
    if (stored.use == MapToUse::Use::kResumeSession) session->resume_session();
    mapping_session_ = session.get();
    slam_ = std::move(session);
    return;
  }
  auto tracker = std::make_unique<MapTracker>(config, stored.map, pool);
  if (start) tracker->set_pose(start->T_a_b, start->covariance);
  map_tracker_ = tracker.get();
  slam_ = std::move(tracker);
}

}  // namespace topogeo::localization
