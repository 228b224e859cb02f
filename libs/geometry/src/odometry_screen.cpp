#include "topogeo/geometry/odometry_screen.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <utility>

namespace topogeo::geometry {
namespace {

// No indoor robot is as fast, and no odometry as coarse.
constexpr double kFastestMps = 5.0;
constexpr double kJump_m = 0.5;
constexpr double kFastestRadps = 2.0 * std::numbers::pi;
constexpr double kJump_rad = 1.0;
// At the origin. In sound logs, jitter adds 0.14 m and, between stamps that are 7 ms apart, 0.54
// rad to motions of up to 2.5 m/s and 4 rad/s, but not where it leads to the origin.
constexpr double kOrigin_m = 0.05;
constexpr double kOrigin_rad = 0.05;
constexpr double kFastToOriginMps = 2.5;
constexpr double kJumpToOrigin_m = 0.15;
constexpr double kFastToOriginRadps = 4.0;
constexpr double kJumpToOrigin_rad = 0.3;
// A robot whose odometry comes back after outliers has driven on as usual.
constexpr double kUsualMps = 1.5;
// Outliers that do not agree with each other.
constexpr std::size_t kMostRuns = 32;
// A run is odometry whatever its stamps say.
constexpr std::size_t kLongestRun = 1000;
constexpr std::size_t kLeastAtEnd = 3;
constexpr std::size_t kShortRun = 2;
constexpr std::size_t kMostNotes = 5;

struct Step {
  double time_s = 0.0;
  double distance_m = 0.0;
  double turn_rad = 0.0;
};

Step step_between(const OdometrySample& a, const OdometrySample& b) {
  const Pose2 step = between(a.T_odom_robot, b.T_odom_robot);
  return {std::fabs(static_cast<double>(b.stamp_ns - a.stamp_ns) * 1e-9), step.position_m().norm(),
          std::fabs(step.theta_rad)};
}

bool is_origin(const Pose2& pose) {
  return pose.position_m().norm() <= kOrigin_m && std::fabs(pose.theta_rad) <= kOrigin_rad;
}

/// Distance of two readings in one number; a turn counts as much as the way of a wheel.
double length_m(const OdometrySample& a, const OdometrySample& b) {
  constexpr double kWheel_m = 0.3;
  const Step step = step_between(a, b);
  return step.distance_m + kWheel_m * step.turn_rad;
}

std::string break_text(const OdometrySample& a, const OdometrySample& b, std::int64_t first_ns) {
  const Step step = step_between(a, b);
  char text[160];
  std::snprintf(text, sizeof(text),
                "the odometry restarts %.1f s after its beginning (a jump of %.2f m and %.0f "
                "degrees): the place is found again by the scans",
                static_cast<double>(b.stamp_ns - first_ns) * 1e-9, step.distance_m,
                step.turn_rad * 180.0 / std::numbers::pi);
  return text;
}

}  // namespace

bool is_possible_step(const OdometrySample& a, const OdometrySample& b) {
  const Step step = step_between(a, b);
  if (step.distance_m > kJump_m + kFastestMps * step.time_s) return false;
  if (step.turn_rad > kJump_rad + kFastestRadps * step.time_s) return false;
  if (!is_origin(b.T_odom_robot)) return true;
  return step.distance_m <= kJumpToOrigin_m + kFastToOriginMps * step.time_s &&
         step.turn_rad <= kJumpToOrigin_rad + kFastToOriginRadps * step.time_s;
}

void OdometryScreen::add(const OdometrySample& sample) {
  const Waiting reading{sample, added_++};
  if (!first_ns_) first_ns_ = sample.stamp_ns;
  if (last_ && runs_.empty() && is_possible_step(*last_, sample)) {
    accept(reading);
    return;
  }
  Run* run = run_before(sample);
  if (comes_back(sample, run)) {
    cut_runs();
    accept(reading);
    return;
  }
  if (run == nullptr) {
    if (runs_.size() == kMostRuns) {
      cut_ += runs_.front().size();
      runs_.erase(runs_.begin());
    }
    run = &runs_.emplace_back();
  }
  run->push_back(reading);
  const std::int64_t lasts_ns = run->back().sample.stamp_ns - run->front().sample.stamp_ns;
  if ((run->size() >= kLeastReadings && lasts_ns >= kLeast_ns) || run->size() >= kLongestRun) {
    begin_epoch(Run(*run));
  }
}

/// The latest run that the reading continues; null if there is none.
OdometryScreen::Run* OdometryScreen::run_before(const OdometrySample& sample) {
  Run* latest = nullptr;
  for (Run& run : runs_) {
    if (!is_possible_step(run.back().sample, sample)) continue;
    if (latest == nullptr || latest->back().number < run.back().number) latest = &run;
  }
  return latest;
}

/// Whether the reading continues the current epoch rather than a run.
bool OdometryScreen::comes_back(const OdometrySample& sample, const Run* run) const {
  if (!last_ || !is_possible_step(*last_, sample)) return false;
  const Step step = step_between(*last_, sample);
  if (step.distance_m > kJump_m + kUsualMps * step.time_s) return false;
  if (run == nullptr) return true;
  // A robot that drives on after a restart may pass where it was before.
  return run->size() <= kShortRun &&
         length_m(*last_, sample) < length_m(run->back().sample, sample);
}

void OdometryScreen::accept(const Waiting& reading) {
  last_ = reading.sample;
  good_.push_back({reading.sample, epochs_ == 0 ? 0 : epochs_ - 1, reading.number});
}

void OdometryScreen::begin_epoch(const Run& run) {
  if (last_) {
    if (breaks_.size() < kMostNotes) {
      breaks_.push_back(break_text(*last_, run.front().sample, *first_ns_));
    } else {
      ++more_breaks_;
    }
  } else {
    last_ = run.front().sample;  // for the distances of what is cut
  }
  ++epochs_;
  std::erase_if(runs_,
                [&](const Run& other) { return other.front().number == run.front().number; });
  cut_runs();
  for (const Waiting& reading : run) accept(reading);
}

void OdometryScreen::cut_runs() {
  for (const Run& run : runs_) {
    cut_ += run.size();
    for (const Waiting& reading : run) {
      farthest_cut_m_ = std::max(farthest_cut_m_, step_between(*last_, reading.sample).distance_m);
    }
  }
  runs_.clear();
}

void OdometryScreen::finish() {
  const auto longest = std::ranges::max_element(runs_, {}, &Run::size);
  if (longest == runs_.end()) return;
  if (last_) {
    if (longest->size() >= kLeastAtEnd) {
      begin_epoch(Run(*longest));
    } else {
      cut_runs();
    }
    return;
  }
  // So few readings do not show which of them can be.
  Run all;
  for (const Run& run : runs_) all.insert(all.end(), run.begin(), run.end());
  std::ranges::sort(all, {}, &Waiting::number);
  runs_.clear();
  begin_epoch(all);
}

std::vector<OdometryScreen::Reading> OdometryScreen::take() {
  return std::exchange(good_, {});
}

std::uint64_t OdometryScreen::decided() const {
  std::uint64_t first = added_;
  for (const Run& run : runs_) first = std::min(first, run.front().number);
  return first;
}

std::vector<std::string> OdometryScreen::notes() const {
  std::vector<std::string> notes;
  if (cut_ > 0) {
    char text[160];
    std::snprintf(text, sizeof(text),
                  "%zu odometry %s left out: no robot can have jumped there (up to %.1f m)", cut_,
                  cut_ == 1 ? "pose is" : "poses are", farthest_cut_m_);
    notes.emplace_back(text);
  }
  notes.insert(notes.end(), breaks_.begin(), breaks_.end());
  if (more_breaks_ > 0) {
    notes.push_back("the odometry restarts " + std::to_string(more_breaks_) + " more times");
  }
  return notes;
}

}  // namespace topogeo::geometry
