#include "map_part.hpp"

#include <utility>

#include "topogeo/geometry/portable_math.hpp"

namespace topogeo::localization {

using geometry::Pose2;

MapPart::MapPart(std::uint32_t number, const LocalizerConfig& config,
                 std::unique_ptr<MatchPool> pool)
    : number_(number),
      pool_(std::move(pool)),
      session_(std::make_unique<MappingSession>(config, *pool_)) {}

MapPart::MapPart(std::uint32_t number, const std::shared_ptr<const StoredMap>& stored)
    : number_(number), own_(stored->trajectory), edges_(edges_of(*stored)) {
  for (const topomap::LocalMap& map : stored->maps) {
    places_[map.stop] = static_cast<std::uint32_t>(maps_.size());
    maps_.push_back(MapPointer(stored, &map));
  }
  place_as_own();
}

void MapPart::place_as_own() {
  poses_.clear();
  for (const topomap::StopPose& stop : own_.stops) {
    poses_.push_back({stop.T_map_robot, stop.covariance});
  }
}

void MapPart::add(const MapPointer& map) {
  if (session_->add(map)) moved_ = true;
  read_session();
}

void MapPart::finish() {
  if (!session_) return;
  session_->finish();
  moved_ = true;
  read_session();
}

void MapPart::end() {
  if (!session_) return;
  edges_ = session_->edges();
  counts_ = session_->counts();
  session_.reset();
  pool_.reset();
}

// Known stops keep their place; a new one is placed relative to its predecessor, as in the part.
void MapPart::read_session() {
  own_ = session_->trajectory();
  maps_ = session_->maps();
  std::map<topomap::StopId, std::uint32_t> places;
  std::vector<UncertainPose> poses;
  const std::vector<topomap::StopPose>& stops = own_.stops;
  for (std::uint32_t i = 0; i < stops.size(); ++i) {
    places[stops[i].stop] = i;
    if (const auto held = find(stops[i].stop)) {
      poses.push_back(poses_[*held]);
    } else if (i == 0) {
      poses.push_back({stops[i].T_map_robot, stops[i].covariance});
    } else {
      const Pose2 step = geometry::between(stops[i - 1].T_map_robot, stops[i].T_map_robot);
      poses.push_back(compose(poses.back(), {step, usual_match_covariance()}));
    }
  }
  moved_ |= places.size() < places_.size();
  places_ = std::move(places);
  poses_ = std::move(poses);
}

const std::vector<PoseGraphEdge>& MapPart::edges() const {
  return session_ ? session_->edges() : edges_;
}

std::optional<std::uint32_t> MapPart::find(const topomap::StopId& stop) const {
  const auto found = places_.find(stop);
  if (found == places_.end()) return std::nullopt;
  return found->second;
}

void MapPart::move(const Pose2& T_new_old) {
  const auto [sin, cos] = geometry::sincos(T_new_old.theta_rad);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() << cos, -sin, sin, cos;
  for (UncertainPose& pose : poses_) {
    pose.T_a_b = T_new_old * pose.T_a_b;
    pose.covariance = turn * pose.covariance * turn.transpose();
  }
}

}  // namespace topogeo::localization
