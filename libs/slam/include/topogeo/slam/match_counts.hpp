// Number of match requests and their results.
#pragma once

#include <array>
#include <cstdint>

#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

struct MatchCounts {
  std::uint64_t tasks = 0;
  std::uint64_t evaluations = 0;
  std::array<std::uint64_t, kReasons> reasons{};  ///< index: Reason; kNone: accepted
};

}  // namespace topogeo::localization
