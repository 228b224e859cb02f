#include "topogeo/localization/mapping/slam.hpp"

#include <stdexcept>
#include <string>

#include "topogeo/localization/mapping/localizer.hpp"
#include "topogeo/localization/thesis/thesis_localizer.hpp"

namespace topogeo::localization {

void check_next(const topomap::LocalMap& map, std::size_t next_id, const topomap::LocalMap* first) {
  if (map.id != next_id) {
    throw std::invalid_argument("localizer: local map " + std::to_string(map.id) +
                                " came, expected " + std::to_string(next_id));
  }
  if (first != nullptr && map.robot_id != first->robot_id) {
    throw std::invalid_argument("localizer: local map " + std::to_string(map.id) +
                                " is of robot '" + map.robot_id + "', expected '" +
                                first->robot_id + "'");
  }
}

std::unique_ptr<Slam> make_slam(const LocalizerConfig& config, MatchPool& pool,
                                GraphOptimizer* optimizer) {
  if (config.mode == LocalizerMode::kThesis) {
    return std::make_unique<ThesisLocalizer>(config, pool);
  }
  return std::make_unique<Localizer>(config, pool, optimizer);
}

}  // namespace topogeo::localization
