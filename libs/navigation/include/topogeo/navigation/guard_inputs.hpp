// The surroundings that the collision guard obeys: the points of the last scan, the echoes of the
// sonars that the laser does not see, and drawn places, all carried on by odometry.
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

class GuardInputs {
 public:
  /// Points around the robot, robot frame now.
  struct Obstacles {
    std::vector<Eigen::Vector2d> points_m;
    std::size_t first_drawn = 0;  ///< the points from this index on are drawn places
  };

  explicit GuardInputs(const GuardConfig& config) : config_(config) {}

  // Each in time order; data that is not newer than the previous is ignored.
  void add(const OdometrySample& odometry);
  void add(const ScanPoints& scan);
  void add(const SonarRound& sonar);

  /// Sets points (robot frame at that time) without a real obstacle that must not be touched.
  /// Replaces earlier ones. Odometry carries them on for 3 m; after that, without newer ones, their
  /// place is too uncertain and they no longer count.
  void keep_off(std::int64_t stamp_ns, std::vector<Eigen::Vector2d> points_m);

  /// Why the sensors allow no motion at all; kNone when they work. `message` may be null.
  [[nodiscard]] HaltReason health(std::int64_t now_ns, std::string* message) const;
  [[nodiscard]] bool has_fresh_sonar(std::int64_t now_ns) const;
  [[nodiscard]] Obstacles obstacles(std::int64_t now_ns) const;
  /// The velocity that odometry measured.
  [[nodiscard]] geometry::Velocity driven() const;
  /// s; age of the place to which obstacles() carries the obstacles; >= 0.
  [[nodiscard]] double age_s(std::int64_t now_ns) const;

 private:
  [[nodiscard]] bool fresh(std::int64_t stamp_ns, std::int64_t now_ns) const;
  void add_sensed(std::int64_t now_ns, std::vector<Eigen::Vector2d>& points_m) const;
  void add_drawn(std::vector<Eigen::Vector2d>& points_m) const;
  /// Whether the scan has a point in the sonar's cone within this distance.
  [[nodiscard]] bool laser_sees(const SonarReading& reading, double up_to_m) const;
  void compare_echoes();
  void watch_silence(const SonarRound& sonar);

  GuardConfig config_;
  geometry::OdometryTrack odometry_{0};
  std::optional<OdometrySample> last_;
  std::optional<ScanPoints> scan_;  ///< smoothed
  std::optional<SonarRound> sonar_;
  struct Echo {
    Eigen::Vector2d point_m;  ///< robot frame at that time
    bool laser_sees;          ///< in the last scan, of any age
  };
  std::vector<Echo> echoes_;  ///< of the last round
  std::optional<geometry::Pose2> T_odom_sonar_round_;
  std::optional<std::int64_t> silent_since_ns_;
  std::vector<Eigen::Vector2d> drawn_m_;  ///< robot frame at T_odom_drawn_
  geometry::Pose2 T_odom_drawn_;
};

}  // namespace topogeo::navigation
