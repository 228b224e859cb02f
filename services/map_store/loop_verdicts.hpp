// Collects the decisions about loops of all drives, to keep them with the map as its evidence.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "topogeo/messaging/events.hpp"
#include "topogeo/msg/trajectory.h"
#include "topogeo/service/decision_assembly.hpp"
#include "topogeo/storage/loop_verdict.hpp"

namespace topogeo::map_store {

class LoopVerdicts {
 public:
  /// Most verdicts kept, about 2 MB: beyond it the oldest rejected ones are dropped.
  static constexpr std::size_t kMost = 8192;

  /// `stored` are those of the map that is continued, whose stops have their numbers since
  /// trajectory version `numbered_since`.
  LoopVerdicts(std::vector<storage::LoopVerdict> stored, std::uint64_t numbered_since);

  /// Decisions of a localizer. An earlier one's stay, unless the stops were renumbered.
  /// Throws std::invalid_argument like service::from_msg.
  void add(const msg::LoopDecisions& message, const messaging::Handle& localizer);

  /// Grows with each message that was used.
  [[nodiscard]] std::uint64_t changes() const { return changes_; }
  [[nodiscard]] std::uint64_t numbered_since() const { return numbered_since_; }
  /// Sorted by step; the newest one of each pair of stops and step.
  [[nodiscard]] std::vector<storage::LoopVerdict> all() const;

 private:
  std::vector<storage::LoopVerdict> earlier_;  // of drives before
  service::DecisionAssembly newest_;
  messaging::Handle localizer_{};
  std::uint64_t numbered_since_ = 0;
  std::uint64_t changes_ = 0;
};

/// The verdicts about stops with numbers below `stops`.
std::vector<storage::LoopVerdict> within(std::vector<storage::LoopVerdict> verdicts,
                                         std::uint32_t stops);

}  // namespace topogeo::map_store
