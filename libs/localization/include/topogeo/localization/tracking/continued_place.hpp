// Where a robot that is lost must be unless it was carried: the last place that was certain, and
// the steps from there on by stops that were matched with each other.
//
// A robot that leaves the map is lost, and what it sees there may look like a piece of the map. A
// step that was matched shows that nothing carried it, so a place that its own stops contradict
// needs far more evidence than one that they lead to. Two pieces of corridor match, too: what the
// map says of the view from the place that the steps lead to shows whether they were one drive.
#pragma once

#include <optional>

#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/tracking/drive_window.hpp"
#include "topogeo/localization/tracking/global_localization.hpp"

namespace topogeo::localization {

class ContinuedPlace {
 public:
  /// The robot went on to its next stop.
  void move(const DriveStep& step);
  /// At this stop it was tracked and matched with the map, this far from the stop before.
  void track(const UncertainPose& T_map_robot, double distance_m);
  /// What the map says of the view of a stop from there, for each stop that was not tracked. A
  /// robot that has left the map sees what the map knows nothing of; where the map saw past what it
  /// sees, it is not there, and something carried it though its steps look like one drive.
  void compare(const KnownView& view, double distance_m);
  /// Nothing is known.
  void forget();

  /// T_map_robot by the stops of the drive; nothing where none was certain since the robot may have
  /// been carried.
  [[nodiscard]] const std::optional<UncertainPose>& pose() const { return pose_; }
  /// Whether the robot may be there without having been carried; true where nothing is known.
  [[nodiscard]] bool leads_to(const UncertainPose& T_map_robot) const;
  /// Over how much path a place must be seen before it is taken, metres: 0 where the drive leads
  /// there, otherwise twice as much as the robot was tracked over in the places that it
  /// contradicts.
  [[nodiscard]] double wanted_m(const UncertainPose& T_map_robot) const;

 private:
  std::optional<UncertainPose> pose_;
  double tracked_m_ = 0.0;  // in all since nothing was known
  KnownView seen_;          // sums since it was tracked
  double since_m_ = 0.0;    // of path since the last one
};

}  // namespace topogeo::localization
