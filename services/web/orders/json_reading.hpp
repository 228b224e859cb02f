// Checked reading of fields in received JSON.
#pragma once

#include <optional>

#include "server/bounded_json.hpp"

namespace topogeo::web {

// All functions throw std::invalid_argument naming key and expectation.

/// A number in [least, most]; nothing when the key is missing.
std::optional<double> number(const Json& json, const char* key, double least, double most);
/// The same for a required key.
double needed(const Json& json, const char* key, double least, double most);

}  // namespace topogeo::web
