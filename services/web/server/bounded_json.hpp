// JSON of peers that nobody has to trust: the work that a text makes grows with its length alone.
#pragma once

#include <cstddef>
#include <string_view>

#include "server/json_values.hpp"

namespace topogeo::web {

inline constexpr std::size_t kMostKeys = 64;    ///< of one object
inline constexpr std::size_t kMostLevels = 16;  ///< of objects and lists inside each other

/// The content of a text. Discarded (Json::is_discarded) for a text that is no JSON, has an object
/// with more keys or has more levels: an ordered object is searched from its beginning for each of
/// its keys.
Json parse_bounded(std::string_view text);

/// The same of a text that must be an object; throws std::invalid_argument where it is none.
Json object_of(std::string_view text);

}  // namespace topogeo::web
