// A task inside a worker, from its arrival to its result.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/topomap/local_map.hpp"

namespace topogeo::search_pool {

using MapPointer = std::shared_ptr<const topomap::LocalMap>;

struct MatchJob {
  std::uint64_t ticket = 0;   ///< chosen by the caller, returned with the outcome
  std::string client_id;      ///< sender of the task
  std::string robot_id;       ///< robot of the maps
  std::int64_t stamp_ns = 0;  ///< of the task's message
  localization::MatchTask task;
};

/// A job with the maps that it names.
struct ReadyJob {
  MatchJob job;
  MapPointer reference;
  MapPointer query;
  std::vector<MapPointer> pieces;  ///< of a whole map, instead of the two (PlaceQuestion::pieces)
};

}  // namespace topogeo::search_pool
