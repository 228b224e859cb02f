// Answers to GET besides the files of the page: tiles, details of a point, facts about the service.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "channels/map_view.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// The value of a key in "x_m=1.2&y_m=3.4"; empty when the key is missing.
std::string query_value(std::string_view query, std::string_view key);

/// A whole number, 0 or more. Throws std::invalid_argument naming `key`.
std::uint64_t parse_number(std::string_view text, const char* key);

/// "/tiles/{layer}/{frame}/{level}/{column}/{row}.png" of a map; `map` may be null.
Answer tile_answer(const Request& request, const ShownMap* map);

/// "/api/at?x_m=..&y_m=..".
Answer point_answer(const Request& request, const ShownMap* map);

}  // namespace topogeo::web
