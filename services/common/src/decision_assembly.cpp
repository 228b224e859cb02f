#include "topogeo/service/decision_assembly.hpp"

#include <utility>

#include "topogeo/service/conversions.hpp"

namespace topogeo::service {

void DecisionAssembly::add(const msg::LoopDecisions& message) {
  if (message.numbered_since() < numbered_since_) return;
  std::vector<localization::LoopDecision> decisions = from_msg(message);
  if (message.numbered_since() > numbered_since_) segments_.clear();
  numbered_since_ = message.numbered_since();
  std::vector<localization::LoopDecision>& held = segments_[message.segment()];
  if (decisions.size() > held.size()) held = std::move(decisions);
}

std::vector<localization::LoopDecision> DecisionAssembly::all() const {
  std::vector<localization::LoopDecision> decisions;
  std::uint32_t next = 0;
  for (const auto& [segment, part] : segments_) {
    if (segment != next++) break;
    decisions.insert(decisions.end(), part.begin(), part.end());
    if (part.size() < msg::kSegmentDecisions) break;
  }
  return decisions;
}

}  // namespace topogeo::service
