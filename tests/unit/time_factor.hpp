// How many times longer tests may wait because of a compiled-in sanitizer, see
// cmake/TopogeoSanitizer.cmake.
#pragma once

#ifndef TOPOGEO_TIME_FACTOR
#define TOPOGEO_TIME_FACTOR 1
#endif

namespace topogeo::test {

constexpr int kTimeFactor = TOPOGEO_TIME_FACTOR;

}  // namespace topogeo::test
