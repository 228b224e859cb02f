#include "markov_mode.hpp"

#include <algorithm>
#include <cmath>

#include "topogeo/planning/place_names.hpp"

namespace topogeo::navigation {

void MarkovMode::set_map(const planning::HybridMap* map) {
  if (!on()) return;
  // A robot that was never located keeps the base station, if there is one.
  if (const auto found = tracker_ ? tracker_->fix() : std::nullopt) {
    T_map_station_ = found->T_map_robot;
  }
  tracker_.reset();
  tried_ns_.reset();
  if (map == nullptr) return;
  const MarkovTrackerConfig& markov = config_.markov;
  if (const planning::Place* place = planning::find_base_station(map->places(), markov.station);
      place != nullptr && !T_map_station_) {
    T_map_station_ =
        geometry::Pose2{place->position_m.x(), place->position_m.y(),
                        place->station_heading_rad.value_or(markov.station_heading_rad)};
  }
  tracker_.emplace(map->space().seen(), config_.markov);
  if (odometry_) tracker_->add(*odometry_);
}

void MarkovMode::add(const PoseFix& base_station) {
  if (base_station.tracking && !T_map_station_) T_map_station_ = base_station.T_map_robot;
}

void MarkovMode::add(const OdometrySample& odometry) {
  odometry_ = odometry;
  if (tracker_) tracker_->add(odometry);
}

void MarkovMode::add(const ScanPoints& scan) {
  constexpr double kStep_rad = 0.17453292519943295;  // ten degrees
  if (on() && config_.markov_by_laser) hear(laser_round(scan, kStep_rad));
}

void MarkovMode::add(const SonarRound& sonar) {
  if (on() && !config_.markov_by_laser) hear(sonar);
}

void MarkovMode::hear(const SonarRound& round) {
  round_ = round;
  if (tracker_ && tracker_->started() && !looks()) tracker_->hear(round);
}

std::optional<PoseFix> MarkovMode::pose() {
  if (!tracker_) return std::nullopt;
  if (!tracker_->started() && T_map_station_ && round_ && odometry_ &&
      tried_ns_ != round_->stamp_ns) {
    tried_ns_ = round_->stamp_ns;
    tracker_->start(*T_map_station_, *round_);
  }
  if (tracker_->started()) return tracker_->fix();
  if (!odometry_) return std::nullopt;
  PoseFix unknown;
  unknown.stamp_ns = odometry_->stamp_ns;
  unknown.state_text = T_map_station_ ? tracker_->reason() : "the base station is not known";
  return unknown;
}

void MarkovMode::primitive_done() {
  if (tracker_) tracker_->primitive_done();
}

void MarkovMode::set_path(std::span<const planning::PathSample> path,
                          std::span<const Eigen::Vector2d> nodes_m) {
  constexpr double kOnPath_m = 0.5;     // a path off the walls may pass beside the middle of a node
  constexpr double kJustBegun_m = 0.3;  // it has looked there already
  nodes_at_m_.clear();
  next_node_ = 0;
  // A grid of poses uses the sonars while driving.
  if (!on() || path.empty() || config_.markov.grid == MarkovGrid::kPoses) return;
  for (const Eigen::Vector2d& node_m : nodes_m) {
    const auto off_m = [&](const planning::PathSample& sample) {
      return (sample.T_map_robot.position_m() - node_m).norm();
    };
    const auto nearest =
        std::min_element(path.begin(), path.end(),
                         [&](const auto& a, const auto& b) { return off_m(a) < off_m(b); });
    if (off_m(*nearest) < kOnPath_m && nearest->distance_m > kJustBegun_m) {
      nodes_at_m_.push_back(nearest->distance_m);
    }
  }
  std::sort(nodes_at_m_.begin(), nodes_at_m_.end());
}

bool MarkovMode::comes_to_node(double progress_m) {
  if (next_node_ >= nodes_at_m_.size() || progress_m < nodes_at_m_[next_node_]) return false;
  ++next_node_;
  return true;
}

std::optional<double> MarkovMode::look(std::int64_t now_ns) {
  constexpr std::int64_t kRollsOut_ns = 800'000'000;  // until the base stands
  if (!look_ns_ || !tracker_ || !tracker_->started() || !round_) return std::nullopt;
  if (round_->stamp_ns < *look_ns_ + kRollsOut_ns || now_ns < round_->stamp_ns) return std::nullopt;
  tracker_->perceive(*round_);
  look_ns_.reset();
  return tracker_->corrected_m();
}

}  // namespace topogeo::navigation
