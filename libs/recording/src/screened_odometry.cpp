#include "screened_odometry.hpp"

#include <algorithm>
#include <cstdio>

namespace topogeo::recording {

void ScreenedOdometry::add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot) {
  screen_.add({stamp_ns, T_odom_robot, 0.0, 0.0});
  take();
}

void ScreenedOdometry::finish() {
  screen_.finish();
  take();
  for (Epoch& epoch : epochs_) epoch.track.finish();
}

void ScreenedOdometry::take() {
  for (const geometry::OdometryScreen::Reading& reading : screen_.take()) {
    if (epochs_.empty() || epochs_.back().number != reading.epoch) {
      epochs_.push_back({reading.epoch, {}});
    }
    epochs_.back().track.add(reading.sample.stamp_ns, reading.sample.T_odom_robot);
  }
}

std::optional<ScreenedOdometry::Answer> ScreenedOdometry::at(std::int64_t stamp_ns) const {
  for (const bool covered : {true, false}) {
    for (auto epoch = epochs_.rbegin(); epoch != epochs_.rend(); ++epoch) {
      if (covered && !epoch->track.covers(stamp_ns)) continue;
      const auto T_odom_robot = epoch->track.at(stamp_ns);
      if (T_odom_robot) return Answer{*T_odom_robot, epoch->number};
    }
  }
  return std::nullopt;
}

OdometryTrack::Gap ScreenedOdometry::gap_at(std::int64_t stamp_ns) const {
  OdometryTrack::Gap around;
  for (const Epoch& epoch : epochs_) {
    const OdometryTrack::Gap gap = epoch.track.gap_at(stamp_ns);
    if (gap.before_ns && gap.after_ns) return gap;  // within one epoch
    if (gap.before_ns) around.before_ns = std::max(gap.before_ns, around.before_ns);
    if (gap.after_ns && (!around.after_ns || *gap.after_ns < *around.after_ns)) {
      around.after_ns = gap.after_ns;
    }
  }
  return around;
}

std::vector<std::string> ScreenedOdometry::notes() const {
  constexpr std::int64_t kSlow_ns = 500'000'000;
  std::vector<std::string> notes = screen_.notes();
  for (const Epoch& epoch : epochs_) {
    if (epoch.track.period_ns() < kSlow_ns) continue;
    char text[120];
    std::snprintf(text, sizeof(text),
                  "odometry comes only each %.2f s: poses between are interpolated",
                  static_cast<double>(epoch.track.period_ns()) * 1e-9);
    notes.emplace_back(text);
    break;
  }
  return notes;
}

}  // namespace topogeo::recording
