// Whether the robot knows where it is, in one word and one number.
#pragma once

#include <cstddef>
#include <cstdint>

namespace topogeo::localization {

enum class LocalizationState : std::uint8_t {
  kTracking = 0,   ///< followed from stop to stop by accepted matches
  kAmbiguous = 1,  ///< odometry or uncertain matches alone, or more than one place fits
  kSearching = 2,  ///< no pose yet, or lost and looking for it; the pose means nothing
  kLost = 3,       ///< what is seen contradicts the pose; the pose means nothing
};

inline constexpr std::size_t kLocalizationStates = 4;

/// "TRACKING", "AMBIGUOUS", "SEARCHING", "LOST".
const char* to_string(LocalizationState state);

/// Whether a pose in this state means anything.
inline bool located(LocalizationState state) {
  return state == LocalizationState::kTracking || state == LocalizationState::kAmbiguous;
}

struct LocalizationStatus {
  LocalizationState state = LocalizationState::kSearching;
  double confidence = 0.0;  ///< probability that the pose is right (0.3 m, 5 degrees), [0, 1]
};

}  // namespace topogeo::localization
