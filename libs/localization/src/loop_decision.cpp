#include "topogeo/localization/loop_decision.hpp"

#include <array>

namespace topogeo::localization {

const char* to_string(LoopOutcome outcome) {
  static constexpr std::array<const char*, kLoopOutcomes> kNames{
      "accepted", "match not believed", "unconfirmed", "no consistent closing", "outvoted"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

}  // namespace topogeo::localization
