// The places of a map at which a robot may be, while its pose is searched for.
//
// Places that fit a stop become hypotheses; they move along with odometry and are weighed by what
// the following stops see, against the possibility that the robot is somewhere else, until one of
// them is left: a filter over few, discrete poses. Whoever uses it finds the places and matches the
// stops; nothing here depends on how.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/localization/matching/odometry_model.hpp"
#include "topogeo/localization/tracking/drive_agreement.hpp"

namespace topogeo::localization {

/// A place where the robot may be.
struct PlaceHypothesis {
  UncertainPose pose;          ///< T_map_robot
  double weight = 0.0;         ///< probability; together with the others and "elsewhere" 1
  std::uint32_t seen = 0;      ///< stops that were matched there
  std::uint32_t accepted = 0;  ///< of them, those whose match passed its gate
  DriveAgreement agreement;    ///< of all of them
  std::uint32_t wanted = 0;    ///< as many accepted before the place is taken
  double distance_m = 0.0;     ///< driven since the first of them
  double fitness = 0.0;        ///< mean over the stops that were seen there
  std::uint32_t missed = 0;    ///< stops in succession that were not matched there
};

class PlaceSearch {
 public:
  /// Forgets all: a search begins.
  void begin();

  /// The robot has moved: `odometry` is T_before_after over this distance.
  void move(const UncertainPose& odometry, double distance_m);
  /// Adds the places that fit the stop and are near no hypothesis.
  void propose(std::span<const geometry::Pose2> T_map_robot);
  /// The same of the place to which the drive leads, whenever that comes up.
  void expect(const geometry::Pose2& T_map_robot);
  /// What matching the stop at a hypothesis gave: T_map_robot of a plausible match (see
  /// plausible()), or nothing.
  struct Observation {
    UncertainPose T_map_robot;
    bool accepted = true;
    double confidence = 1.0;  ///< that it is right, see match_confidence()
  };
  void observe(std::size_t hypothesis, const std::optional<Observation>& measured);
  /// Weighs the hypotheses by how well the stop fits there, in [0, 1], one number for each; those
  /// that have come to the same place become one, hopeless ones are dropped. Throws
  /// std::invalid_argument unless there are as many numbers as hypotheses.
  void weigh(std::span<const double> fitness);
  /// Ends the work on one stop.
  void end_stop() { ++stops_; }

  [[nodiscard]] const std::vector<PlaceHypothesis>& hypotheses() const { return hypotheses_; }
  /// The one of largest weight; nothing without any.
  [[nodiscard]] std::optional<PlaceHypothesis> best() const;
  /// Whether it is the place: beyond doubt, and seen from often and far enough apart. `carried_m`:
  /// over so much path, where the robot can be there only if something carried it unnoticed.
  static bool found(const PlaceHypothesis& hypothesis, double carried_m = 0.0);

 private:
  void merge();

  std::vector<PlaceHypothesis> hypotheses_;
  std::uint32_t stops_ = 0;  // of this search
  double moved_m_ = 0.0;     // since the last weighing
};

}  // namespace topogeo::localization
