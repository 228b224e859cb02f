// Turns the individually readable scans of a log into the sequence that Scan promises: strictly
// increasing stamps, the beams of the first scan, numbers from 0 without gaps, odometry epochs that
// no other log has.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::scan {

class ScanSequence {
 public:
  /// A scan with its place in the log, for messages. Its odometry epoch counts from 0.
  struct Candidate {
    Scan scan;
    std::uint64_t place = 0;
  };
  /// Returns the next scan that is readable by itself, without a check of its time; empty at the
  /// end.
  using Source = std::function<std::optional<Candidate>()>;
  /// Called for each skipped scan, with "expected ..., got ...".
  using Skip = std::function<void(SkipReason reason, std::uint64_t place, const std::string& text)>;

  /// `jump_s`: see CarmenLogOptions.
  ScanSequence(double jump_s, Source source, Skip skip);

  /// Empty at the end. The first call reads ahead, because a stamp is confirmed by the next one.
  std::optional<Scan> next();

 private:
  std::optional<Candidate> next_of_same_geometry();
  std::optional<Candidate> take();
  std::optional<Candidate> confirm(Candidate candidate);
  [[nodiscard]] bool same_geometry(const Scan& scan) const;

  std::int64_t jump_ns_;
  Source source_;
  Skip skip_;
  std::optional<Scan> geometry_;         // the first readable scan, which fixes the geometry
  std::optional<Candidate> read_ahead_;  // precedes the rest of the log
  std::optional<std::int64_t> last_ns_;  // stamp of the last accepted scan
  std::uint64_t sequence_ = 0;
  std::uint64_t odometry_epoch_ = 0;  // the first one
};

}  // namespace topogeo::scan
