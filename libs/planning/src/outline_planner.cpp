#include "topogeo/planning/outline_planner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "topogeo/support/format.hpp"

#include "outline_field.hpp"
#include "outline_moves.hpp"
#include "outline_search.hpp"

namespace topogeo::planning {
namespace {

/// Samples of moves as a follower takes them: headings are those of the travel.
class SampledMoves {
 public:
  explicit SampledMoves(const geometry::Pose2& start) : pose_(start) {}

  void add(const OutlineMove& move) {
    // A follower turns the shorter way round, so a long turn has stops on its way.
    constexpr double kMost_rad = 2.0;
    const int parts =
        std::max(1, static_cast<int>(std::ceil(std::fabs(move.turn_rad) / kMost_rad)));
    const bool back = move.length_m < 0.0;
    for (int k = 1; k <= parts; ++k) {
      pose_ = after(pose_, OutlineMove{move.turn_rad / parts});
      if (k < parts) push(0.0, move.turn_rad / parts, back);
    }
    drive(move.length_m, move.turn_rad / parts, move.curvature_per_m);
  }

  std::vector<PathSample> finish() {
    push(0.0, 0.0, !samples_.empty() && samples_.back().backward);
    return std::move(samples_);
  }

 private:
  void drive(double signed_m, double turn_rad, double curvature_per_m) {
    constexpr double kStep_m = 0.1;
    const double length_m = std::fabs(signed_m);
    if (length_m == 0.0) return;
    const int steps = std::max(1, static_cast<int>(std::ceil(length_m / kStep_m)));
    for (int k = 0; k < steps; ++k) {
      push(length_m / steps, k == 0 ? turn_rad : 0.0, signed_m < 0.0, curvature_per_m);
      pose_ = after(pose_, OutlineMove{0.0, signed_m / steps, curvature_per_m});
    }
  }

  // Left is to the right of a robot that reverses.
  void push(double on_m, double turn_rad, bool back, double curvature_per_m = 0.0) {
    PathSample sample;
    sample.curvature_per_m = back ? -curvature_per_m : curvature_per_m;
    sample.T_map_robot = pose_;
    if (back)
      sample.T_map_robot.theta_rad = geometry::wrap_angle(pose_.theta_rad + std::numbers::pi);
    sample.distance_m = distance_m_;
    sample.turn_on_spot_rad = turn_rad;
    sample.backward = back;
    samples_.push_back(sample);
    distance_m_ += on_m;
  }

  geometry::Pose2 pose_;
  double distance_m_ = 0.0;
  std::vector<PathSample> samples_;
};

OutlinePath failure(OutlineStatus status, std::string reason) {
  return {status, std::move(reason), {}};
}

}  // namespace

OutlinePath plan_outline(const FreeSpace& space, const geometry::Pose2& T_map_robot,
                         const PoseGoal& goal, std::span<const Eigen::Vector2d> obstacles_m,
                         const OutlineConfig& config) {
  const OutlineField field(space, obstacles_m, config);
  const OutlineMoves moves(space, field, config, T_map_robot, goal);
  const auto shown = [](const Eigen::Vector2d& at_m) {
    return fmt::format("({:.2f}, {:.2f})", at_m.x(), at_m.y());
  };
  if (goal.heading_rad) {
    const geometry::Pose2 end{goal.position_m.x(), goal.position_m.y(), *goal.heading_rad};
    if (!moves.free(end, field.clearance_m(end))) {
      return failure(OutlineStatus::kGoalBlocked,
                     fmt::format("the outline of the robot does not fit at {} in this heading",
                                 shown(goal.position_m)));
    }
  }
  auto path = search_moves(field, moves, config, T_map_robot, goal);
  if (!path) {
    std::string reason =
        fmt::format("no path from {} to {} is wide enough for the outline of the robot",
                    shown(T_map_robot.position_m()), shown(goal.position_m));
    if (config.minimum_radius_m > 0.0) {
      reason += fmt::format(", which cannot turn within {:.2f} m", config.minimum_radius_m);
    }
    return failure(OutlineStatus::kUnreachable, std::move(reason));
  }
  OutlinePath result;
  result.status = OutlineStatus::kFound;
  SampledMoves samples(T_map_robot);
  for (const OutlineMove& move : shortened(moves, T_map_robot, goal, std::move(*path))) {
    samples.add(move);
  }
  result.samples = samples.finish();
  return result;
}

}  // namespace topogeo::planning
