// Merges two maps of one place (docs/exchange.md, "Merging maps").
//
// Aligns the maps, then maps the drives of one into the other, as if the robot had driven them
// there later: each stop is matched with those that should look alike, and agreement deforms both
// maps. Their content decides which one is continued, so both orders give the same map, each in the
// frame of the first.
#pragma once

#include <cstddef>

#include "topogeo/exchange/align.hpp"
#include "topogeo/exchange/output_file.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/storage/map_document.hpp"

namespace topogeo::exchange {

struct MergedMap {
  Alignment alignment;            ///< of the smaller map in the larger one
  bool merged = false;            ///< false: no stop joined, the document is empty
  storage::MapDocument document;  ///< in the frame and with the robot of `a`
  std::size_t joined = 0;         ///< stops of the smaller map
  std::size_t left_out = 0;       ///< its stops without a match
  Notes notes;
};

/// Places, zones and the grid drawn on `a` replace those of the same names on `b`. Throws
/// std::invalid_argument like align(), and if both have stops of one session.
MergedMap merge(const storage::MapDocument& a, const storage::MapDocument& b,
                const pipeline::Config& config);

}  // namespace topogeo::exchange
