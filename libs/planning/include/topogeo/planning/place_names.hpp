// Finds places by names that people write.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// The place with exactly that name; otherwise the only place whose name differs just in the case
/// of the letters A to Z; null if there is none, or more than one.
const Place* find_place(std::span<const Place> places, std::string_view name);

/// The base station with that name, like find_place; otherwise the only base station, or, without
/// any, the place with that name, which has no heading.
const Place* find_base_station(std::span<const Place> places, std::string_view name);

/// At most `most` names of places, ordered by the number of insertions, deletions and replacements
/// of letters that turn them into `name`, ignoring case; the original order breaks ties.
std::vector<std::string> similar_names(std::span<const Place> places, std::string_view name,
                                       std::size_t most);

}  // namespace topogeo::planning
