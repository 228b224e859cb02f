// Dead reckoning of a lost robot: the last certain place plus the steps since, over stops that were
// matched with each other. A robot that was not carried must be there.
//
// A robot that leaves the map is lost, and its surroundings there may look like a piece of the map.
// A matched step shows that nothing carried the robot, so a place that its own stops contradict
// needs far more evidence than one that they lead to. Two pieces of corridor match, too: the view
// predicted by the map at the end of the steps shows whether they were one drive.
#pragma once

#include <optional>

#include "topogeo/matching/odometry_model.hpp"
#include "topogeo/relocalization/global_localization.hpp"

#include "drive_window.hpp"

namespace topogeo::localization {

class ContinuedPlace {
 public:
  /// The robot moved on to its next stop.
  void move(const DriveStep& step);
  /// At this stop it was tracked and matched with the map, this far from the previous stop.
  void track(const UncertainPose& T_map_robot, double distance_m);
  /// Compares the view of a stop that was not tracked with the map at pose(). A robot outside the
  /// map sees things that the map does not know. If the map saw past the things in view, the robot
  /// is not there, and something carried it although its steps look like one drive.
  void compare(const KnownView& view, double distance_m);
  /// Forgets everything.
  void forget();

  /// T_map_robot by the stops of the drive; empty if no place has been certain since the robot may
  /// have been carried.
  [[nodiscard]] const std::optional<UncertainPose>& pose() const { return pose_; }
  /// Whether the robot can be there without having been carried; true without a pose().
  [[nodiscard]] bool leads_to(const UncertainPose& T_map_robot) const;
  /// Path over which a place must be seen before it is accepted, metres: 0 if the drive leads
  /// there, otherwise twice the path tracked in the places that it contradicts.
  [[nodiscard]] double wanted_m(const UncertainPose& T_map_robot) const;

 private:
  std::optional<UncertainPose> pose_;
  double tracked_m_ = 0.0;  // total since the last forget()
  KnownView seen_;          // sums since the last tracked stop
  double since_m_ = 0.0;    // path since the last view
};

}  // namespace topogeo::localization
