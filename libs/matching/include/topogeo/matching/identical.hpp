// Equality to the last bit, for values that must not differ between machines. Unlike with ==, 0 and
// -0 differ, and a NaN equals itself.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/match.hpp"

namespace topogeo::localization {

bool identical(double a, double b);
bool identical(const geometry::Pose2& a, const geometry::Pose2& b);
/// Compares every field.
bool identical(const MatchResult& a, const MatchResult& b);

}  // namespace topogeo::localization
