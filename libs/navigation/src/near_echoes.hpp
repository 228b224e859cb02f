// Keeps room to objects that sonars hear at their least range. Sonars cannot measure a shorter
// distance, so a robot with a pose error may touch them unnoticed: while it drives along them, or
// turns on the spot on wheels that shift it. It moves off by itself, unless something is on the
// other side.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/velocity.hpp"
#include "topogeo/navigation/guard_config.hpp"
#include "topogeo/navigation/navigator_inputs.hpp"

namespace topogeo::navigation {

class NearEchoes {
 public:
  explicit NearEchoes(const GuardConfig& config) : config_(config) {}

  // Each in time order.
  void add(const OdometrySample& odometry) { odometry_ = odometry; }
  void add(const SonarRound& sonar);

  /// The wanted velocity plus a component away from near echoes of the last seconds: curved away
  /// from objects on one side only, and ahead or back while the robot turns on the spot. Unchanged
  /// if a laser sees near objects, or there are none.
  [[nodiscard]] geometry::Velocity make_room(const geometry::Velocity& wanted,
                                             std::int64_t now_ns) const;

 private:
  struct Near {
    Eigen::Vector2d point_m;  ///< odometry frame
    std::int64_t heard_ns;
  };
  void forget_before(const SonarReading& reading);
  void note(const SonarReading& reading, std::int64_t heard_ns);

  GuardConfig config_;
  std::optional<OdometrySample> odometry_;
  std::vector<Near> near_;
};

}  // namespace topogeo::navigation
