// All loop decisions of a robot from the segments in which they travel, in whatever order they
// come.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "topogeo/localization/mapping/loop_decision.hpp"
#include "topogeo/msg/trajectory.h"

namespace topogeo::service {

class DecisionAssembly {
 public:
  /// A segment older than the one that is held, or of other numbers than the newest, is passed
  /// over. Throws std::invalid_argument like
  /// from_msg.
  void add(const msg::LoopDecisions& message);

  /// The decisions from the first one up to the first that has not come.
  [[nodiscard]] std::vector<localization::LoopDecision> all() const;

 private:
  std::map<std::uint32_t, std::vector<localization::LoopDecision>> segments_;
  std::uint64_t numbered_since_ = 0;  // of all of them
};

}  // namespace topogeo::service
