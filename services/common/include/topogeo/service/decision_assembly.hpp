// Assembles all loop decisions of a robot from their segments, which may arrive in any order.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "topogeo/msg/trajectory.h"
#include "topogeo/slam/loop/loop_decision.hpp"

namespace topogeo::service {

class DecisionAssembly {
 public:
  /// Ignores a segment that is older than the one held, or numbered differently from the newest.
  /// Throws std::invalid_argument like from_msg.
  void add(const msg::LoopDecisions& message);

  /// The decisions up to the first one that is missing.
  [[nodiscard]] std::vector<localization::LoopDecision> all() const;

 private:
  std::map<std::uint32_t, std::vector<localization::LoopDecision>> segments_;
  std::uint64_t numbered_since_ = 0;  // of all decisions
};

}  // namespace topogeo::service
