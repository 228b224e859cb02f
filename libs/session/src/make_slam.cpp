#include "topogeo/session/slam_session.hpp"
#include "topogeo/slam/pose_graph_slam.hpp"

namespace topogeo::localization {

std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer) {
  check(config);
  if (config.mode == SlamAlgorithm::kThesis) return config.added_mode.get()->make(config, pool);
  return std::make_unique<PoseGraphSlam>(config, pool, optimizer);
}

}  // namespace topogeo::localization
