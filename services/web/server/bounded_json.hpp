// JSON from untrusted peers: the work for a text grows only with its length.
#pragma once

#include <cstddef>
#include <string_view>

#include "server/json_values.hpp"

namespace topogeo::web {

inline constexpr std::size_t kMostKeys = 64;    ///< of one object
inline constexpr std::size_t kMostLevels = 16;  ///< of objects and lists inside each other

/// Parses a text. Returns a discarded value (Json::is_discarded) for text that is no JSON, has an
/// object with too many keys or too many levels: an ordered object is searched from its beginning
/// for each key.
Json parse_bounded(std::string_view text);

/// The same for a text that must be an object; throws std::invalid_argument otherwise.
Json object_of(std::string_view text);

}  // namespace topogeo::web
