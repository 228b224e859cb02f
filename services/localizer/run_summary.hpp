// What a localizer has done in a run, as the message for those who report on the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "topogeo/localization/mapping/slam.hpp"
#include "topogeo/localization/session/mapping_session.hpp"
#include "topogeo/localization/tracking/map_localizer.hpp"
#include "topogeo/msg/stream.h"
#include "topogeo/search_pool/task_board.hpp"

namespace topogeo::localizer {

struct RunParts {
  const localization::Slam& slam;
  const localization::MapLocalizer* in_map;       ///< null: no map that stays as it is was given
  const localization::MappingSession* continued;  ///< null: no map was extended
  const search_pool::BoardCounts& pool;
};

/// Throws std::invalid_argument for a robot id over its bound.
msg::RunSummary make_run_summary(const RunParts& parts, const std::string& robot_id,
                                 std::int64_t stamp_ns);

}  // namespace topogeo::localizer
