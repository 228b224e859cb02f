#include "orders/json_reading.hpp"

#include <stdexcept>

#include "topogeo/support/format.hpp"

namespace topogeo::web {

std::optional<double> number(const Json& json, const char* key, double least, double most) {
  const auto found = json.find(key);
  if (found == json.end()) return std::nullopt;
  if (found->is_number()) {
    const auto value = found->get<double>();
    if (value >= least && value <= most) return value;
  }
  throw std::invalid_argument(fmt::format("{}: expected a number from {} to {}", key, least, most));
}

double needed(const Json& json, const char* key, double least, double most) {
  const auto value = number(json, key, least, most);
  if (!value) throw std::invalid_argument(fmt::format("{}: is missing", key));
  return *value;
}

}  // namespace topogeo::web
