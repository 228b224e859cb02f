// Labels of cells, from which zones are made.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

inline constexpr std::uint32_t kNoLabel = std::numeric_limits<std::uint32_t>::max();

struct ZoneLabels {
  std::vector<std::uint32_t> of_cell;  ///< kNoLabel: none yet, or impassable
  std::vector<std::string> names;      ///< by label
  std::vector<bool> stays;             ///< by label: not merged with a neighbour, even if small
};

/// Labels the connected parts of the cells of each owner, in the order of their first cells.
/// `owner_of_cell` is kNoLabel for excluded cells, otherwise an index of `names`. The largest part
/// of an owner gets its name and stays, the others "NAME 2", "NAME 3" ...
void label_parts(const FreeSpace& space, const std::vector<std::uint32_t>& owner_of_cell,
                 const std::vector<std::string>& names, ZoneLabels& labels);

/// Owner 0, without a name, for passable cells.
std::vector<std::uint32_t> passable_owner(const FreeSpace& space);

/// Grows the labels over passable cells without one, labels the cells that they cannot reach,
/// merges too small zones with a neighbour, and numbers the zones in the order of their first
/// cells. Throws std::invalid_argument if there are more zones than a ZoneId can name.
ZoneMap complete(const FreeSpace& space, ZoneLabels labels, const ZoneConfig& config);

}  // namespace topogeo::planning
