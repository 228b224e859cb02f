// Units of scans that drivers get wrong, where no laser could mean what they state: degrees for
// radians, millimetres for metres.
#pragma once

#include <cstdint>

#include "topogeo/ros_conversions/messages.hpp"

namespace topogeo::recording {

/// Converts angles that span more than four turns as radians and one turn at most as degrees.
/// Returns whether it did.
bool correct_degrees(ros::LaserScan& scan);

/// Counts the ranges of a laser to find their unit.
class RangeUnit {
 public:
  void add(const ros::LaserScan& scan);

  /// Whether all but a few of the finite ranges are above 100 and differ: indoors, no laser in
  /// metres measures that, and nearly all in millimetres do.
  [[nodiscard]] bool is_millimetres() const;
  [[nodiscard]] float largest() const { return largest_; }

 private:
  std::uint64_t ranges_ = 0;  // finite and positive
  std::uint64_t large_ = 0;
  float least_large_ = 0.0F;
  float largest_ = 0.0F;
};

/// Converts the ranges, and limits that are in millimetres as well.
void convert_millimetres(ros::LaserScan& scan);

}  // namespace topogeo::recording
