// Fields of JSON that somebody sends, checked.
#pragma once

#include <optional>

#include "server/bounded_json.hpp"

namespace topogeo::web {

// All throw std::invalid_argument naming key and expectation.

/// A number from least to most; nothing when the key is missing.
std::optional<double> number(const Json& json, const char* key, double least, double most);
/// The same of a key that must be there.
double needed(const Json& json, const char* key, double least, double most);

}  // namespace topogeo::web
