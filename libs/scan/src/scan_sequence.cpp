#include "topogeo/scan/scan_sequence.hpp"

#include <cmath>
#include <utility>

namespace topogeo::scan {
namespace {

std::string seconds_text(std::int64_t stamp_ns) {
  const std::string nanoseconds = std::to_string(stamp_ns % 1'000'000'000);
  return std::to_string(stamp_ns / 1'000'000'000) + "." + std::string(9 - nanoseconds.size(), '0') +
         nanoseconds;
}

}  // namespace

ScanSequence::ScanSequence(double jump_s, Source source, Skip skip)
    : jump_ns_(static_cast<std::int64_t>(jump_s * 1e9)),
      source_(std::move(source)),
      skip_(std::move(skip)) {}

bool ScanSequence::same_geometry(const Scan& scan) const {
  constexpr double kTolerance_rad = 1e-6;
  return scan.ranges_m.size() == geometry_->ranges_m.size() &&
         std::fabs(scan.angle_min_rad - geometry_->angle_min_rad) <= kTolerance_rad &&
         std::fabs(scan.angle_step_rad - geometry_->angle_step_rad) <= kTolerance_rad;
}

std::optional<ScanSequence::Candidate> ScanSequence::next_of_same_geometry() {
  while (std::optional<Candidate> candidate = source_()) {
    if (!geometry_) geometry_ = candidate->scan;
    if (!same_geometry(candidate->scan)) {
      skip_(SkipReason::kGeometry, candidate->place,
            "expected " + std::to_string(geometry_->ranges_m.size()) +
                " beams at the angles of the first scan, got " +
                std::to_string(candidate->scan.ranges_m.size()));
      continue;
    }
    // The angles of a log are rounded; one exact geometry saves comparisons.
    candidate->scan.angle_min_rad = geometry_->angle_min_rad;
    candidate->scan.angle_step_rad = geometry_->angle_step_rad;
    return candidate;
  }
  return std::nullopt;
}

// The next scan with a valid time.
std::optional<ScanSequence::Candidate> ScanSequence::take() {
  while (true) {
    std::optional<Candidate> candidate = std::exchange(read_ahead_, std::nullopt);
    if (!candidate) candidate = next_of_same_geometry();
    if (!candidate) return std::nullopt;
    if (last_ns_ && candidate->scan.stamp_ns <= *last_ns_) {
      skip_(SkipReason::kTime, candidate->place,
            "expected a time stamp after " + seconds_text(*last_ns_) + ", got " +
                seconds_text(candidate->scan.stamp_ns));
      continue;
    }
    if (!last_ns_ || candidate->scan.stamp_ns - *last_ns_ > jump_ns_) {
      candidate = confirm(*std::move(candidate));
    }
    last_ns_ = candidate->scan.stamp_ns;
    return candidate;
  }
}

// A candidate far ahead of its predecessor: if it were wrong and accepted, all later scans would
// seem late and be lost. If the next scan is far earlier, yet still after the last accepted one,
// the candidate is the wrong one.
std::optional<ScanSequence::Candidate> ScanSequence::confirm(Candidate candidate) {
  while (true) {
    std::optional<Candidate> following = next_of_same_geometry();
    if (!following) return candidate;
    const std::int64_t following_ns = following->scan.stamp_ns;
    const bool earlier = candidate.scan.stamp_ns - following_ns > jump_ns_;
    const bool usable = !last_ns_ || following_ns > *last_ns_;
    if (!earlier || !usable) {
      read_ahead_ = std::move(following);
      return candidate;
    }
    skip_(SkipReason::kTime, candidate.place,
          "expected a time stamp before that of the next scan, " + seconds_text(following_ns) +
              ", got " + seconds_text(candidate.scan.stamp_ns));
    candidate = *std::move(following);
  }
}

std::optional<Scan> ScanSequence::next() {
  std::optional<Candidate> candidate = take();
  if (!candidate) return std::nullopt;
  if (sequence_ == 0) odometry_epoch_ = fingerprint(candidate->scan);
  candidate->scan.sequence = sequence_++;
  candidate->scan.odometry_epoch += odometry_epoch_;
  return std::move(candidate->scan);
}

}  // namespace topogeo::scan
