// JSON from untrusted peers and files: parsing takes time proportional to the length of the text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::support {

struct JsonLimits {
  std::size_t levels = kMostLevels;  ///< of nested objects and lists
  std::size_t keys = kMostKeys;      ///< of one object
  std::size_t values = kMostValues;  ///< of the text, keys included
};

/// The first limit that a text exceeds, as "more than 100 levels of lists and objects"; empty if it
/// exceeds none, up to the first byte that is no JSON.
[[nodiscard]] std::string beyond_limits(std::string_view text, const JsonLimits& limits = {});

}  // namespace topogeo::support
