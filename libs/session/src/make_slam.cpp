#include "topogeo/session/make_slam.hpp"

#include "topogeo/slam/pose_graph_slam.hpp"
#include "topogeo/thesis/thesis_slam.hpp"

namespace topogeo::localization {

std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer) {
  if (config.mode == SlamAlgorithm::kThesis) {
    return std::make_unique<ThesisSlam>(config, pool);
  }
  return std::make_unique<PoseGraphSlam>(config, pool, optimizer);
}

}  // namespace topogeo::localization
