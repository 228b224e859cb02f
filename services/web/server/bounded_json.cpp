#include "server/bounded_json.hpp"

#include <stdexcept>

#include "topogeo/support/json_limits.hpp"

namespace topogeo::web {

Json parse_bounded(std::string_view text) {
  const support::JsonLimits limits{kMostLevels, kMostKeys, text.size()};
  if (!support::beyond_limits(text, limits).empty()) return Json(Json::value_t::discarded);
  return Json::parse(text, nullptr, false);
}

Json object_of(std::string_view text) {
  Json json = parse_bounded(text);
  if (!json.is_object()) {
    throw std::invalid_argument("expected a JSON object of at most 64 keys");
  }
  return json;
}

}  // namespace topogeo::web
