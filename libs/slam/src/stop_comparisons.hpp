// Pairs of stops that have been matched, with their predictions at that time.
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

namespace topogeo::localization {

class StopComparisons {
 public:
  /// Whether a match of two stops can give anything new: they were not compared yet, or without
  /// success and an optimisation has moved the prediction since.
  [[nodiscard]] bool worth(std::uint32_t earlier, std::uint32_t later,
                           const geometry::Pose2& T_later_earlier) const;

  void record(std::uint32_t earlier, std::uint32_t later, const geometry::Pose2& T_later_earlier,
              bool accepted);
  /// Allows the two to be compared again, whatever the result was.
  void forget(std::uint32_t earlier, std::uint32_t later);

 private:
  struct Comparison {
    geometry::Pose2 T_later_earlier;  // as predicted
    bool accepted = false;
  };
  std::vector<std::map<std::uint32_t, Comparison>> of_later_;  // index: later stop; key: earlier
};

}  // namespace topogeo::localization
