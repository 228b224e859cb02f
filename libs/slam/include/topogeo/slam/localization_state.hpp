// Whether the robot knows its pose: a state and a confidence.
#pragma once

#include <cstddef>
#include <cstdint>

namespace topogeo::localization {

enum class LocalizationState : std::uint8_t {
  kTracking = 0,   ///< followed from stop to stop by accepted matches
  kAmbiguous = 1,  ///< by odometry or uncertain matches only, or several places fit
  kSearching = 2,  ///< no pose yet, or lost and searching; the pose is meaningless
  kLost = 3,       ///< the scan contradicts the pose; the pose is meaningless
};

inline constexpr std::size_t kLocalizationStates = 4;

/// "TRACKING", "AMBIGUOUS", "SEARCHING", "LOST".
const char* to_string(LocalizationState state);

/// Whether a pose in this state is meaningful.
inline bool located(LocalizationState state) {
  return state == LocalizationState::kTracking || state == LocalizationState::kAmbiguous;
}

struct LocalizationStatus {
  LocalizationState state = LocalizationState::kSearching;
  double confidence = 0.0;  ///< probability that the pose is within 0.3 m and 5 degrees, [0, 1]
};

}  // namespace topogeo::localization
