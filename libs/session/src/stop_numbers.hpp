// Numbers of the stops in a map of several growing parts.
//
// The map lists the stops part by part, as if the robots had driven one after the other. A new stop
// of any part but the last shifts the numbers of all later parts, so such stops are numbered in
// batches.
#pragma once

#include <cstddef>
#include <cstdint>

#include "joint_poses.hpp"

namespace topogeo::localization {

class StopNumbers {
 public:
  /// Number of waiting stops that are numbered together.
  static constexpr std::size_t kTogether = 16;

  explicit StopNumbers(std::uint64_t numbered_since = 0) : numbered_since_(numbered_since) {}

  /// Updates to the stops of these parts; `all`: numbers every stop now. `version`: the new version
  /// of the map.
  void update(const PartOrder& parts, bool all, std::uint64_t version);

  /// The numbered stops, in order of their numbers.
  [[nodiscard]] const PartOrder& order() const { return order_; }
  /// Version of the last change of a number.
  [[nodiscard]] std::uint64_t numbered_since() const { return numbered_since_; }

 private:
  PartOrder order_;
  std::uint64_t numbered_since_;
};

}  // namespace topogeo::localization
