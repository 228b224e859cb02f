#include "topogeo/slam/loop/loop_decision.hpp"

#include <array>

#include "topogeo/matching/match_gate.hpp"

namespace topogeo::localization {

const char* to_string(LoopOutcome outcome) {
  static constexpr std::array<const char*, kLoopOutcomes> kNames{
      "accepted", "match not accepted", "unconfirmed", "no consistent closing", "outvoted"};
  return kNames.at(static_cast<std::size_t>(outcome));
}

const char* to_string(ProposalSource source) {
  switch (source) {
    case ProposalSource::kPrediction:
      return "prediction";
    case ProposalSource::kPlace:
      return "place";
    case ProposalSource::kWindow:
      return "window";
  }
  return "unknown";
}

std::string explanation(const LoopDecision& decision) {
  std::string text = to_string(decision.outcome);
  if (decision.reason != Reason::kNone) text += std::string(": ") + to_string(decision.reason);
  return text;
}

}  // namespace topogeo::localization
