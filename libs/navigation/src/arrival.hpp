// Arrival: the robot stands, finds its exact pose, corrects the remaining error and has arrived.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/navigator_config.hpp"
#include "topogeo/planning/motion_primitives.hpp"

namespace topogeo::navigation {

/// State of the robot at the end of its path.
struct ArrivalView {
  geometry::Pose2 T_map_robot;
  std::optional<std::int64_t> fix_ns;  ///< stamp of the last pose fix
  bool tracking = false;               ///< the localizer is certain
  Eigen::Vector2d goal_m = Eigen::Vector2d::Zero();
  std::optional<double> heading_rad;  ///< wanted at the goal
};

struct ArrivalStep {
  enum class Kind {
    kStands,  ///< and waits for a pose at this place
    kMoves,   ///< follows `path`, turns to `heading_rad`, and arrives again
    kArrived,
  };
  Kind kind = Kind::kStands;
  std::vector<planning::PathSample> path;
  std::optional<double> heading_rad;
  std::string message;  ///< one line for people
};

class Arrival {
 public:
  explicit Arrival(const NavigatorConfig& config) : config_(config) {}

  /// Another goal or route: restores all attempts.
  void reset();
  /// The robot is at the end of its path and stands from now on.
  void begin(std::int64_t now_ns);
  /// The robot has another task first.
  void interrupt() { settle_ns_.reset(); }
  /// An obstacle blocks the last centimetres: only the heading remains to be corrected.
  void accept_position();
  /// Markov localization has checked its pose.
  void note_look() { looked_ = settling(); }

  [[nodiscard]] bool settling() const { return settle_ns_.has_value(); }
  /// Whether Markov localization still has to check its pose.
  [[nodiscard]] bool needs_look() const { return settling() && !looked_; }

  /// The next step while it settles.
  ArrivalStep step(const ArrivalView& view, std::int64_t now_ns);

 private:
  ArrivalStep look_around(const ArrivalView& view);
  ArrivalStep correct(const ArrivalView& view, double off_m);

  const NavigatorConfig& config_;
  std::optional<std::int64_t> settle_ns_;  ///< start of standing
  bool looked_ = false;
  int looks_ = 0;  ///< turns at the goal, until the localizer is certain
  int corrections_ = 0;
};

}  // namespace topogeo::navigation
