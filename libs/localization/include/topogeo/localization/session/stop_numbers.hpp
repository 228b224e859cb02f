// Which numbers the stops of a map of several parts have while all of them grow.
//
// The map is the stops of one part after the other, as if one robot had driven there after the
// other. A stop that comes to any part but the last one stands before others, which get other
// numbers then; so such stops are numbered some at a time.
#pragma once

#include <cstddef>
#include <cstdint>

#include "topogeo/localization/session/joint_poses.hpp"

namespace topogeo::localization {

class StopNumbers {
 public:
  /// So many stops that have no number yet get theirs together.
  static constexpr std::size_t kTogether = 16;

  explicit StopNumbers(std::uint64_t numbered_since = 0) : numbered_since_(numbered_since) {}

  /// The stops of these parts; `all`: each of them gets its number now. `version`: of the map from
  /// now on.
  void update(const PartOrder& parts, bool all, std::uint64_t version);

  /// The stops that have numbers, in the order of these.
  [[nodiscard]] const PartOrder& order() const { return order_; }
  /// Version since which no stop got another number.
  [[nodiscard]] std::uint64_t numbered_since() const { return numbered_since_; }

 private:
  PartOrder order_;
  std::uint64_t numbered_since_;
};

}  // namespace topogeo::localization
