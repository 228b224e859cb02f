// Two maps of one place become one (docs/exchange.md, "Merging maps").
//
// The maps are aligned, then the drives of one are mapped into the other, as if the robot had
// driven them there after it: every stop is matched with those that should look alike, and what
// agrees bends both. Which of the two is continued follows from their content, so both orders give
// the same map, each in the frame of the first.
#pragma once

#include <cstddef>

#include "topogeo/exchange/align.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct MergedMap {
  Alignment alignment;            ///< of the smaller map in the larger one
  bool merged = false;            ///< false: nothing joined, the document is empty
  storage::MapDocument document;  ///< in the frame of `a`, of its robot
  std::size_t joined = 0;         ///< stops of the smaller map
  std::size_t left_out = 0;       ///< those that found no place
  Notes notes;
};

/// Places, zones and the grid that are drawn on `a` count before those of the same names on `b`.
/// Throws std::invalid_argument as align(), and when both have stops of one session.
MergedMap merge(const storage::MapDocument& a, const storage::MapDocument& b,
                const pipeline::Config& config);

}  // namespace topogeo::exchange
