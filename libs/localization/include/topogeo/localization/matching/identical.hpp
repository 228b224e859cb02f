// Equality to the last bit, for what must not differ between machines: unlike for ==, 0 and -0
// differ, and a value that is not a number equals itself.
#pragma once

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/match.hpp"

namespace topogeo::localization {

bool identical(double a, double b);
bool identical(const geometry::Pose2& a, const geometry::Pose2& b);
/// Every field.
bool identical(const MatchResult& a, const MatchResult& b);

}  // namespace topogeo::localization
