// Equality of two answers to a match task, for the comparison of workers.
#pragma once

#include "topogeo/localization/match.hpp"

namespace topogeo::localizer {

/// True when every field has the same bits.
bool identical(const localization::MatchResult& a, const localization::MatchResult& b);

}  // namespace topogeo::localizer
