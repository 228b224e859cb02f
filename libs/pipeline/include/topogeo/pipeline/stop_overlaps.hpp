// Stops of a finished map with a common view, and the searches between matched ones, for
// inspection.
#pragma once

#include <cstdint>
#include <vector>

#include "topogeo/pipeline/stop_search.hpp"
#include "topogeo/slam/localizer_config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::pipeline {

/// The search for a stop in an earlier one that it is matched with in the map.
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

/// Overlaps of every stop but the first. The searches start from the poses in the map with the
/// uncertainty of a pose given by a person; 20 ms each. Only stops with a pose count. Throws like
/// search_stop().
std::vector<StopOverlaps> stop_overlaps(const storage::MapDocument& map,
                                        const localization::LocalizerConfig& config);

}  // namespace topogeo::pipeline
