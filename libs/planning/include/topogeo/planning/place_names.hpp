// Places by names as people write them.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/planning/zones.hpp"

namespace topogeo::planning {

/// The place of exactly that name; without one the only place whose name differs from it in capital
/// letters (A to Z) alone; null when there is none, or more than one.
const Place* find_place(std::span<const Place> places, std::string_view name);

/// The base station of that name, as find_place; without one the only base station there is, and
/// without any the place of that name, which has no heading.
const Place* find_base_station(std::span<const Place> places, std::string_view name);

/// At most so many names of places: first those that take the fewest insertions, deletions and
/// exchanges of letters to become `name`, capitals or not; of equal ones those that come first.
std::vector<std::string> similar_names(std::span<const Place> places, std::string_view name,
                                       std::size_t most);

}  // namespace topogeo::planning
