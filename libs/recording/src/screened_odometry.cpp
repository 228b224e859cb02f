#include "screened_odometry.hpp"

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
  for (const bool covered : {true, false}) {
    for (auto epoch = epochs_.rbegin(); epoch != epochs_.rend(); ++epoch) {
      if (covered && !epoch->track.covers(stamp_ns)) continue;
      const auto T_odom_robot = epoch->track.at(stamp_ns);
      if (T_odom_robot) return Answer{*T_odom_robot, epoch->number};
    }
  }
  return std::nullopt;
}

std::optional<double> ScreenedOdometry::distance_s(std::int64_t stamp_ns) const {
  std::optional<double> nearest_s;
  for (const Epoch& epoch : epochs_) {
    const std::optional<double> distance_s = epoch.track.distance_s(stamp_ns);
    if (distance_s && (!nearest_s || *distance_s < *nearest_s)) nearest_s = distance_s;
  }
  return nearest_s;
}

}  // namespace topogeo::recording
