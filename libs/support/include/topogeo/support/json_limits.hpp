// JSON of peers and files that nobody has to trust: the work that a text makes grows with its
// length alone.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "topogeo/support/foreign_file.hpp"

namespace topogeo::support {

struct JsonLimits {
  std::size_t levels = kMostLevels;  ///< of objects and lists inside each other
  std::size_t keys = kMostKeys;      ///< of one object
  std::size_t values = kMostValues;  ///< of the text, keys included
};

/// The first limit that a text is beyond, as "more than 100 levels of lists and objects";
/// empty when it is within all, up to the first byte that is no JSON.
[[nodiscard]] std::string beyond_limits(std::string_view text, const JsonLimits& limits = {});

}  // namespace topogeo::support
