// Which stops of a finished map see the same, and what a search finds of those that were matched:
// for looking at.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/localization/mapping/localizer_config.hpp"
#include "topogeo/pipeline/stop_search.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::pipeline {

/// The search for a stop in an earlier one that the map holds a match of.
struct SearchedStop {
  std::uint32_t earlier = 0;
  StopSearch search;
};

struct StopOverlaps {
  std::uint32_t stop = 0;
  /// Ascending: the earlier stops whose fields of view overlap with this one's at their poses in
  /// the map (Thesis, definition 7.3.3).
  std::vector<std::uint32_t> overlap_set;
  std::vector<SearchedStop> searches;  ///< ascending by the earlier stop
};

/// Of every stop but the first. The searches start from the poses in the map, known as well as a
/// pose that a person states; 20 ms each. Only stops that have a pose count. Throws like
/// search_stop().
std::vector<StopOverlaps> stop_overlaps(const storage::MapDocument& map,
                                        const localization::LocalizerConfig& config);

}  // namespace topogeo::pipeline
