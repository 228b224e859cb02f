// The scans of a log whose odometry can be and whose laser does not hang; each has the number of
// its odometry epoch.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/odometry_screen.hpp"
#include "topogeo/scan/repeated_readings.hpp"
#include "topogeo/scan/scan_sequence.hpp"

namespace topogeo::scan {

class ScreenedScans {
 public:
  ScreenedScans(ScanSequence::Source source, ScanSequence::Skip skip);

  /// Empty at the end. Reads ahead while it is unclear whether odometry can be.
  std::optional<ScanSequence::Candidate> next();

  /// For people, about the scans read so far.
  [[nodiscard]] std::vector<std::string> notes() const { return screen_.notes(); }

 private:
  void read();
  void decide();

  ScanSequence::Source source_;
  ScanSequence::Skip skip_;
  geometry::OdometryScreen screen_;
  RepeatedReadings repeated_;
  std::deque<ScanSequence::Candidate> waiting_;  // undecided
  std::uint64_t first_waiting_ = 0;              // its number in the screen
  std::deque<ScanSequence::Candidate> good_;
  bool ended_ = false;
};

}  // namespace topogeo::scan
