// Summary of a localizer's run, as the message for programs that report on the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "topogeo/msg/stream.h"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/search_pool/task_board.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/slam/slam.hpp"

namespace topogeo::localizer {

struct RunParts {
  const localization::Slam& slam;
  const localization::MapTracker* in_map;         ///< null: it did not localize in a finished map
  const localization::MappingSession* continued;  ///< null: it extended no map
  const search_pool::BoardCounts& pool;
};

/// Throws std::invalid_argument for a robot id over its bound.
msg::RunSummary make_run_summary(const RunParts& parts, const std::string& robot_id,
                                 std::int64_t stamp_ns);

}  // namespace topogeo::localizer
