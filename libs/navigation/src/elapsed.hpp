// Times between stamps.
#pragma once

#include <cstdint>

namespace topogeo::navigation {

/// Seconds from one stamp to another.
constexpr double elapsed_s(std::int64_t from_ns, std::int64_t to_ns) {
  return static_cast<double>(to_ns - from_ns) * 1e-9;
}

}  // namespace topogeo::navigation
