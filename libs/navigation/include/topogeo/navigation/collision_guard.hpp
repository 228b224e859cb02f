// Keeps a robot from driving into what its laser and sonars see, whatever the planner of its path
// wants. It has no map, no pose and no route (MACONDO, I and III; docs/algorithms.md, "Driving and
// collision guard"). Drawn walls and no-go zones are points that its owner puts around the robot
// while it knows where that is.
//
// The points of the last scan, carried on by odometry, and the echoes of the sonars where the laser
// sees nothing in their cone are what the body's disc must not touch on the arc that is wanted, nor
// on the one that the robot is on. From the free distance follows the speed from which it still
// stops in time, whatever happens: the age of what it sees, its delay and the time that the base
// runs on without its gateway count (geometry/reaction_times.hpp). Noise of the laser is smoothed
// over neighbouring beams by no more than the side margin, so a measured point itself is never
// touched.
//
// A second line are the fields that the laser itself watches, which know nothing of odometry, body
// or mounting (Thesis, appendix B.1).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/geometry/odometry_track.hpp"
#include "topogeo/geometry/pose2.hpp"
#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

struct GuardVerdict {
  geometry::Velocity allowed;             ///< the wanted motion, slower on the same arc, or none
  HaltReason reason = HaltReason::kNone;  ///< why nothing is allowed at all
  std::string message;                    ///< for people; empty when the motion is allowed
  double free_m = 0.0;   ///< along the wanted motion before the body touches something; <= 5
  bool limited = false;  ///< slower than wanted
  /// What stands where the free distance ends, robot frame; nothing when nothing does within 5 m,
  /// or what is there is only drawn.
  std::optional<Eigen::Vector2d> contact_m;
};

class CollisionGuard {
 public:
  static constexpr double kFarthest_m = 5.0;

  /// Throws std::invalid_argument as `check`.
  explicit CollisionGuard(const GuardConfig& config);

  // Each in time order; what is not newer than the one before is left out.
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);
  void add(const LaserFields& fields);

  /// Points (robot frame at that time) that must not be touched though nothing stands there, in
  /// place of those before. Odometry carries them on for 3 m; then, without newer ones, nobody
  /// knows where they are, and they do not count.
  void keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m);

  /// What of a wanted velocity is safe now. Turning on the spot of a round body always is, as long
  /// as the sensors work. Backwards it goes only where fresh sonars point.
  [[nodiscard]] GuardVerdict judge(const geometry::Velocity& wanted, std::int64_t now_ns) const;

  /// Why no motion at all is allowed; kNone when the sensors work. `message` may be null.
  [[nodiscard]] HaltReason health(std::int64_t now_ns, std::string* message = nullptr) const;

 private:
  [[nodiscard]] bool fresh(std::int64_t stamp_ns, std::int64_t now_ns) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> obstacles_m(std::int64_t now_ns) const;
  /// Adds what is to be kept off, in the robot frame of now.
  void add_drawn(std::vector<Eigen::Vector2d>& points_m) const;
  [[nodiscard]] geometry::Velocity driven() const;
  /// s; from what it sees until the base surely brakes.
  [[nodiscard]] double reaction_s(std::int64_t now_ns) const;
  /// m/s; the speed from which it stops within a free distance.
  [[nodiscard]] double speed_for(double free_m, double reaction_s) const;
  /// Whether the scan has a point in the sonar's cone, at most so far from it.
  [[nodiscard]] bool laser_sees(const SonarReading& reading, double up_to_m) const;
  /// What the fields of the laser leave of a verdict.
  void obey_fields(GuardVerdict& verdict) const;
  [[nodiscard]] GuardVerdict judge_by_distances(const geometry::Velocity& wanted,
                                                std::int64_t now_ns) const;
  void compare_echoes();
  void watch_silence(const SonarRound& sonar);

  GuardConfig config_;
  geometry::OdometryTrack odometry_{0};
  std::optional<OdometrySample> last_;
  std::optional<ScanPoints> scan_;  ///< smoothed
  std::optional<SonarRound> sonar_;
  struct Echo {
    Eigen::Vector2d point_m;  ///< robot frame at that time
    bool laser_sees;          ///< in the last scan, however old that is
  };
  std::vector<Echo> echoes_;  ///< of the last round
  std::optional<geometry::Pose2> T_odom_sonar_round_;
  std::optional<std::int64_t> silent_since_ns_;
  std::optional<LaserFields> fields_;
  std::vector<Eigen::Vector2d> drawn_m_;  ///< robot frame at T_odom_drawn_
  geometry::Pose2 T_odom_drawn_;
};

}  // namespace topogeo::navigation
