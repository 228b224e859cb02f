#include <array>

#include "topogeo/slam/state_monitor.hpp"

namespace topogeo::localization {

const char* to_string(LocalizationState state) {
  static constexpr std::array<const char*, kLocalizationStates> kNames{"TRACKING", "AMBIGUOUS",
                                                                       "SEARCHING", "LOST"};
  return kNames.at(static_cast<std::size_t>(state));
}

}  // namespace topogeo::localization
