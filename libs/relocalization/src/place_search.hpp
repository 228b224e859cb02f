// Possible places of a robot in a map during the search for its pose.
//
// Places that fit a stop become hypotheses. They move with odometry and are weighted by the views
// of the following stops, against the possibility that the robot is somewhere else, until one of
// them is left: a filter over few, discrete poses. The caller finds the places and matches the
// stops; the filter does not depend on how.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/matching/odometry_model.hpp"

#include "drive_agreement.hpp"

namespace topogeo::localization {

/// A possible place of the robot.
struct PlaceHypothesis {
  UncertainPose pose;          ///< T_map_robot
  double weight = 0.0;         ///< probability; all weights and "elsewhere" add up to 1
  std::uint32_t seen = 0;      ///< stops matched there
  std::uint32_t accepted = 0;  ///< of these, matches that passed their gate
  DriveAgreement agreement;    ///< of all these stops
  std::uint32_t wanted = 0;    ///< accepted matches required to take the place
  double distance_m = 0.0;     ///< driven since the first of them
  double fitness = 0.0;        ///< mean over the stops matched there
  std::uint32_t missed = 0;    ///< successive stops not matched there
};

class PlaceSearch {
 public:
  /// Begins a search: forgets everything.
  void begin();

  /// The robot has moved: `odometry` is T_before_after over this distance.
  void move(const UncertainPose& odometry, double distance_m);
  /// Adds places that fit the stop, except near existing hypotheses.
  void propose(std::span<const geometry::Pose2> T_map_robot);
  /// The same for the place that the drive leads to, whenever it is found.
  void expect(const geometry::Pose2& T_map_robot);
  /// Result of matching the stop at a hypothesis: T_map_robot of a plausible match (see
  /// plausible()), or empty.
  struct Observation {
    UncertainPose T_map_robot;
    bool accepted = true;
    double confidence = 1.0;  ///< probability that it is right, see match_confidence()
  };
  void observe(std::size_t hypothesis, const std::optional<Observation>& measured);
  /// Weights the hypotheses by the fitness of the stop at each of them, in [0, 1]. Merges
  /// hypotheses that have reached the same place and drops hopeless ones. Throws
  /// std::invalid_argument unless there is one number per hypothesis.
  void weigh(std::span<const double> fitness);
  /// Ends the work on one stop.
  void end_stop() { ++stops_; }

  [[nodiscard]] const std::vector<PlaceHypothesis>& hypotheses() const { return hypotheses_; }
  /// The hypothesis of largest weight; empty without any.
  [[nodiscard]] std::optional<PlaceHypothesis> best() const;
  /// Whether it is the place: beyond doubt, and seen often and far enough apart. `carried_m`:
  /// required path if the robot can be there only because something carried it unnoticed.
  static bool found(const PlaceHypothesis& hypothesis, double carried_m = 0.0);

 private:
  void merge();

  std::vector<PlaceHypothesis> hypotheses_;
  std::uint32_t stops_ = 0;  // of this search
  double moved_m_ = 0.0;     // since the last weighing
};

}  // namespace topogeo::localization
