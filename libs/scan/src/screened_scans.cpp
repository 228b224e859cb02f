#include "screened_scans.hpp"

#include <utility>

namespace topogeo::scan {

ScreenedScans::ScreenedScans(ScanSequence::Source source, ScanSequence::Skip skip)
    : source_(std::move(source)), skip_(std::move(skip)) {}

std::optional<ScanSequence::Candidate> ScreenedScans::next() {
  while (good_.empty() && !ended_) read();
  if (good_.empty()) return std::nullopt;
  ScanSequence::Candidate candidate = std::move(good_.front());
  good_.pop_front();
  return candidate;
}

void ScreenedScans::read() {
  if (std::optional<ScanSequence::Candidate> candidate = source_()) {
    screen_.add({candidate->scan.stamp_ns, candidate->scan.T_odom_robot, 0.0, 0.0});
    waiting_.push_back(*std::move(candidate));
  } else {
    screen_.finish();
    ended_ = true;
  }
  decide();
}

// The screen has cut out a scan that it has decided about and does not return.
void ScreenedScans::decide() {
  const auto leave = [&] {
    ScanSequence::Candidate candidate = std::move(waiting_.front());
    waiting_.pop_front();
    ++first_waiting_;
    return candidate;
  };
  const auto cut_before = [&](std::uint64_t number) {
    while (first_waiting_ < number) {
      skip_(SkipReason::kPose, leave().place,
            "expected an odometry pose that the robot can have reached, got a jump away and back");
    }
  };
  for (const geometry::OdometryScreen::Reading& reading : screen_.take()) {
    cut_before(reading.number);
    ScanSequence::Candidate candidate = leave();
    Scan& scan = candidate.scan;
    scan.odometry_epoch = reading.epoch;
    if (repeated_.add(scan.ranges_m, scan.T_odom_robot, scan.odometry_epoch)) {
      skip_(SkipReason::kRepeated, candidate.place, std::string(kRepeatedText));
    } else {
      good_.push_back(std::move(candidate));
    }
  }
  cut_before(screen_.decided());
}

}  // namespace topogeo::scan
