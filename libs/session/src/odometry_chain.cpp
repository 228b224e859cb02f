#include "topogeo/session/odometry_chain.hpp"

#include <utility>

#include "topogeo/topomap/odometry_contradiction.hpp"

namespace topogeo::localization {

bool OdometryChain::is_contradicted(const topomap::LocalMap& map) const {
  const geometry::Pose2 T_odom_last = geometry::inverse(T_first_odom_) * last_->T_odom_robot;
  return topomap::odometry_contradiction(T_odom_last, map).has_value();
}

OdometryChain::MapPointer OdometryChain::add(MapPointer map) {
  // The scans before a stop belong to the epoch of the stop before.
  const geometry::Pose2 T_first_track = T_first_odom_;
  const bool same_session = last_ && last_->stop.session == map->stop.session;
  const bool same_epoch = last_ && last_->odometry_epoch == map->odometry_epoch;
  const bool contradicted = same_session && same_epoch && is_contradicted(*map);
  if (same_session && (!same_epoch || contradicted)) {
    T_first_odom_ =
        last_->T_odom_robot * map->T_previous_robot * geometry::inverse(map->T_odom_robot);
  } else if (!same_epoch) {
    T_first_odom_ = {};
  }
  if (T_first_odom_ != geometry::Pose2{} || T_first_track != geometry::Pose2{}) {
    auto chained = std::make_shared<topomap::LocalMap>(*map);
    chained->T_odom_robot = T_first_odom_ * map->T_odom_robot;
    for (topomap::TrackedScan& scan : chained->track) {
      scan.T_odom_robot = T_first_track * scan.T_odom_robot;
    }
    map = std::move(chained);
  }
  last_ = Last{map->stop, map->odometry_epoch, map->T_odom_robot};
  return map;
}

}  // namespace topogeo::localization
