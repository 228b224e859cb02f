#include "screened_odometry.hpp"

#include <algorithm>

namespace topogeo::recording {

void ScreenedOdometry::add(std::int64_t stamp_ns, const geometry::Pose2& T_odom_robot) {
  screen_.add({stamp_ns, T_odom_robot, 0.0, 0.0});
  take();
}

void ScreenedOdometry::finish() {
  screen_.finish();
  take();
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
  for (auto epoch = epochs_.rbegin(); epoch != epochs_.rend(); ++epoch) {
    const auto T_odom_robot = epoch->track.at(stamp_ns);
    if (T_odom_robot) return Answer{*T_odom_robot, epoch->number};
  }
  return std::nullopt;
}

bool ScreenedOdometry::reaches(std::int64_t stamp_ns) const {
  return std::ranges::any_of(epochs_,
                             [&](const Epoch& epoch) { return epoch.track.reaches(stamp_ns); });
}

std::optional<double> ScreenedOdometry::distance_s(std::int64_t stamp_ns) const {
  std::optional<double> nearest_s;
  for (const Epoch& epoch : epochs_) {
    const std::optional<double> distance_s = epoch.track.distance_s(stamp_ns);
    if (distance_s && (!nearest_s || *distance_s < *nearest_s)) nearest_s = distance_s;
  }
  return nearest_s;
}

void ScreenedOdometry::forget_before(std::int64_t stamp_ns) {
  for (Epoch& epoch : epochs_) epoch.track.forget_before(stamp_ns);
  // The scans of an epoch come before those of the next one.
  while (epochs_.size() > 1 && !epochs_.front().track.reaches(stamp_ns)) epochs_.pop_front();
}

}  // namespace topogeo::recording
