// Motions of a robot that is not round, and whether its outline is free along them.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "topogeo/geometry/pose2.hpp"

#include "outline_field.hpp"

namespace topogeo::planning {

/// A turn on the spot and then a straight piece or an arc; either may be nothing.
struct OutlineMove {
  double turn_rad = 0.0;         ///< any number of turns
  double length_m = 0.0;         ///< negative: back
  double curvature_per_m = 0.0;  ///< positive: turns left while it drives ahead
};

/// The pose after a move.
geometry::Pose2 after(const geometry::Pose2& T_map_robot, const OutlineMove& move);

class OutlineMoves {
 public:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  OutlineMoves(const FreeSpace& space, const OutlineField& field, const OutlineConfig& config,
               const geometry::Pose2& start, const PoseGoal& goal);

  /// Cost of a move in metres of a free straight path: more near obstacles, backwards, and for each
  /// turn; kNever if the outline does not fit along it.
  [[nodiscard]] double cost(const geometry::Pose2& from, const OutlineMove& move) const;

  /// Cost of starting to turn, or to drive in the other direction.
  static constexpr double kStop = 0.4;

  /// Moves from a pose straight to another: turn, drive ahead or back, turn; or the arcs and lines
  /// of a base that cannot turn on the spot. The cheapest, or nothing if none is free.
  struct Link {
    std::vector<OutlineMove> moves;
    double cost = kNever;
  };
  [[nodiscard]] std::optional<Link> link(const geometry::Pose2& from, const Eigen::Vector2d& to_m,
                                         std::optional<double> heading_rad) const;

  /// The shortest moves of a search, which lead to other positions or headings.
  [[nodiscard]] std::vector<OutlineMove> pieces() const;
  /// The radius of arcs, metres; 0 for a base that turns on the spot.
  [[nodiscard]] double arc_radius_m() const { return arc_radius_m_; }
  /// Cost of the stop between two moves of a base that drives arcs; 0 for any other.
  [[nodiscard]] double reversal(const OutlineMove& before, const OutlineMove& next) const {
    return arc_radius_m_ > 0.0 && before.length_m * next.length_m < 0.0 ? kStop : 0.0;
  }

  /// Whether the outline is free at a pose. Near the start and the goal it may be as near to an
  /// obstacle as there.
  [[nodiscard]] bool free(const geometry::Pose2& pose, double clearance_m) const;

 private:
  [[nodiscard]] std::optional<Link> link_by_turns(const geometry::Pose2& from,
                                                  const Eigen::Vector2d& to_m,
                                                  std::optional<double> heading_rad) const;
  [[nodiscard]] std::optional<Link> link_by_arcs(const geometry::Pose2& from,
                                                 const Eigen::Vector2d& to_m,
                                                 std::optional<double> heading_rad) const;
  [[nodiscard]] double cost_at(const geometry::Pose2& pose) const;
  [[nodiscard]] bool obeys(const geometry::Pose2& pose, bool ahead) const;

  const FreeSpace& space_;
  const OutlineField& field_;
  double margin_m_;
  double wished_m_;
  double arc_radius_m_;
  Eigen::Vector2d start_m_;
  Eigen::Vector2d goal_m_;
  double start_clearance_m_;
  double goal_clearance_m_;
};

}  // namespace topogeo::planning
