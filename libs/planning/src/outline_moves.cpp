#include "outline_moves.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "topogeo/geometry/portable_math.hpp"

#include "arc_paths.hpp"

namespace topogeo::planning {
namespace {

constexpr double kChecked_m = 0.05;    // between checked poses: half a cell
constexpr double kChecked_rad = 0.07;  // the same for the corners of a long robot
constexpr double kPerTurn = 0.4;       // metres for a radian
constexpr double kBack = 2.0;          // reversing costs as much as this many metres ahead
constexpr double kBesideWall = 2.0;    // added at the least margin
constexpr double kAroundEnds_m = 0.7;  // around start and goal
constexpr double kLeastTurn_rad = 1e-6;
constexpr double kPiece_m = 0.15;  // of a search: always leaves its cell of 0.1 m
constexpr double kPieceTurn_rad = 2.0 * std::numbers::pi / 24.0;
constexpr double kPerBend = 0.1;     // metres for a radian of an arc
constexpr double kArcReserve = 1.1;  // of the smallest radius, for corrections of the follower

double length_of(const OutlineMove& move) {
  return std::fabs(move.length_m) * (move.length_m > 0.0 ? 1.0 : kBack) +
         kPerBend * std::fabs(move.curvature_per_m * move.length_m);
}

/// Moves along a path, and their cost without obstacles, which no cost with obstacles is below.
struct FreeLink {
  std::vector<OutlineMove> moves;
  double cost = 0.0;
};

FreeLink free_link(const ArcPath& path) {
  FreeLink link;
  for (const ArcPiece& piece : path) {
    const OutlineMove move{0.0, piece.length_m, piece.curvature_per_m};
    const bool reverses = !link.moves.empty() && link.moves.back().length_m * move.length_m < 0.0;
    link.cost += length_of(move) + (reverses ? OutlineMoves::kStop : 0.0);
    link.moves.push_back(move);
  }
  return link;
}

}  // namespace

geometry::Pose2 after(const geometry::Pose2& T_map_robot, const OutlineMove& move) {
  const double heading_rad = geometry::wrap_angle(T_map_robot.theta_rad + move.turn_rad);
  return after({T_map_robot.x_m, T_map_robot.y_m, heading_rad},
               ArcPiece{move.length_m, move.curvature_per_m});
}

OutlineMoves::OutlineMoves(const FreeSpace& space, const OutlineField& field,
                           const OutlineConfig& config, const geometry::Pose2& start,
                           const PoseGoal& goal)
    : space_(space),
      field_(field),
      margin_m_(config.margin_m),
      wished_m_(config.wished_m),
      arc_radius_m_(kArcReserve * config.minimum_radius_m),
      start_m_(start.position_m()),
      goal_m_(goal.position_m),
      start_clearance_m_(field.clearance_m(start)),
      goal_clearance_m_(
          goal.heading_rad
              ? field.clearance_m({goal.position_m.x(), goal.position_m.y(), *goal.heading_rad})
              : config.margin_m) {}

bool OutlineMoves::free(const geometry::Pose2& pose, double clearance_m) const {
  constexpr double kCloser_m = 0.01;
  constexpr double kLeastAtGoal_m = 0.07;  // from any cell that the outline covers
  if (clearance_m >= margin_m_) return true;
  if ((pose.position_m() - start_m_).norm() < kAroundEnds_m &&
      clearance_m >= start_clearance_m_ - kCloser_m) {
    return true;
  }
  return (pose.position_m() - goal_m_).norm() < kAroundEnds_m &&
         clearance_m >= std::max(kLeastAtGoal_m, goal_clearance_m_ - kCloser_m);
}

double OutlineMoves::cost_at(const geometry::Pose2& pose) const {
  const double clearance_m = field_.clearance_m(pose);
  if (!free(pose, clearance_m)) return kNever;
  const double near = (wished_m_ - clearance_m) / (wished_m_ - margin_m_);
  return 1.0 + kBesideWall * std::clamp(near, 0.0, 1.0);
}

bool OutlineMoves::obeys(const geometry::Pose2& pose, bool ahead) const {
  if (!space_.rules().guides()) return true;
  const auto cell = space_.frame().cell_of(pose.position_m());
  if (!cell) return false;
  const double sign = ahead ? 1.0 : -1.0;
  const geometry::SinCos heading =
      geometry::sincos(pose.theta_rad - space_.frame().T_map_grid.theta_rad);
  return space_.rules().allows(space_.frame().index(*cell),
                               {sign * heading.cos, sign * heading.sin});
}

double OutlineMoves::cost(const geometry::Pose2& from, const OutlineMove& move) const {
  double sum = 0.0;
  const double turn_rad = std::fabs(move.turn_rad);
  if (turn_rad > kLeastTurn_rad) {
    const int steps = static_cast<int>(std::ceil(turn_rad / kChecked_rad));
    for (int k = 1; k <= steps; ++k) {
      const double here = cost_at(after(from, OutlineMove{move.turn_rad * k / steps}));
      if (here == kNever) return kNever;
      sum += kPerTurn * turn_rad / steps * here;
    }
  }
  const double length_m = std::fabs(move.length_m);
  if (length_m == 0.0) return sum;
  const double each = move.length_m > 0.0 ? 1.0 : kBack;
  const int steps = static_cast<int>(std::ceil(length_m / kChecked_m));
  for (int k = 1; k <= steps; ++k) {
    const geometry::Pose2 pose =
        after(from, OutlineMove{move.turn_rad, move.length_m * k / steps, move.curvature_per_m});
    const double here = cost_at(pose);
    if (here == kNever || !obeys(pose, move.length_m > 0.0)) return kNever;
    double slowness = 1.0;
    if (space_.rules().guides()) {
      const auto cell = space_.frame().cell_of(pose.position_m());
      slowness = double{space_.rules().slowness(space_.frame().index(*cell))};
    }
    sum += each * slowness * length_m / steps * here;
  }
  return sum + kPerBend * std::fabs(move.curvature_per_m) * length_m;
}

std::vector<OutlineMove> OutlineMoves::pieces() const {
  if (arc_radius_m_ == 0.0) {
    return {{0.0, kPiece_m}, {0.0, -kPiece_m}, {kPieceTurn_rad, 0.0}, {-kPieceTurn_rad, 0.0}};
  }
  std::vector<OutlineMove> pieces;
  for (const double length_m : {kPiece_m, -kPiece_m}) {
    for (const double side : {0.0, 1.0, -1.0}) {
      pieces.push_back({0.0, length_m, side / arc_radius_m_});
    }
  }
  return pieces;
}

std::optional<OutlineMoves::Link> OutlineMoves::link(const geometry::Pose2& from,
                                                     const Eigen::Vector2d& to_m,
                                                     std::optional<double> heading_rad) const {
  return arc_radius_m_ > 0.0 ? link_by_arcs(from, to_m, heading_rad)
                             : link_by_turns(from, to_m, heading_rad);
}

std::optional<OutlineMoves::Link> OutlineMoves::link_by_arcs(
    const geometry::Pose2& from, const Eigen::Vector2d& to_m,
    std::optional<double> heading_rad) const {
  constexpr int kHeadings = 16;       // tried at a goal without one
  constexpr std::size_t kTried = 12;  // words whose outline is checked
  std::vector<FreeLink> words;
  const auto add_words = [&](double end_rad) {
    const geometry::Pose2 end{to_m.x(), to_m.y(), end_rad};
    if (!free(end, field_.clearance_m(end))) return;
    for (const ArcPath& path : arc_paths(from, end, arc_radius_m_)) {
      words.push_back(free_link(path));
    }
  };
  if (heading_rad) {
    add_words(*heading_rad);
  } else {
    for (int k = 0; k < kHeadings; ++k) {
      add_words(geometry::wrap_angle(from.theta_rad + 2.0 * std::numbers::pi * k / kHeadings));
    }
  }
  const std::size_t tried = std::min(kTried, words.size());
  std::ranges::partial_sort(words, words.begin() + static_cast<std::ptrdiff_t>(tried), {},
                            &FreeLink::cost);
  Link best;
  for (std::size_t i = 0; i < tried && words[i].cost < best.cost; ++i) {
    Link link{std::move(words[i].moves), 0.0};
    geometry::Pose2 pose = from;
    for (std::size_t k = 0; k < link.moves.size() && link.cost < best.cost; ++k) {
      link.cost += cost(pose, link.moves[k]);
      if (k > 0) link.cost += reversal(link.moves[k - 1], link.moves[k]);
      pose = after(pose, link.moves[k]);
    }
    if (link.cost < best.cost) best = std::move(link);
  }
  if (best.cost == kNever) return std::nullopt;
  return best;
}

std::optional<OutlineMoves::Link> OutlineMoves::link_by_turns(
    const geometry::Pose2& from, const Eigen::Vector2d& to_m,
    std::optional<double> heading_rad) const {
  constexpr double kThere_m = 0.005;
  constexpr double kTurnRound_rad = 2.0 * std::numbers::pi;
  const Eigen::Vector2d line_m = to_m - from.position_m();
  const double length_m = line_m.norm();
  const bool there = length_m < kThere_m;
  const double bearing_rad = there ? from.theta_rad : geometry::atan2(line_m.y(), line_m.x());
  Link best;
  // Either way round, because a wall may be on one side.
  const auto turns = [&](double from_rad, double to_rad) {
    const double short_rad = geometry::wrap_angle(to_rad - from_rad);
    return std::array{short_rad,
                      short_rad > 0.0 ? short_rad - kTurnRound_rad : short_rad + kTurnRound_rad};
  };
  const auto cheapest_turn = [&](const geometry::Pose2& pose, double to_rad) {
    OutlineMove found;
    double least = kNever;
    for (const double turn_rad : turns(pose.theta_rad, to_rad)) {
      const double price = cost(pose, OutlineMove{turn_rad});
      if (price == kNever) continue;
      least = price + (std::fabs(turn_rad) > kLeastTurn_rad ? kStop : 0.0);
      found.turn_rad = turn_rad;
      break;
    }
    return std::pair(found, least);
  };
  for (const double direction : {1.0, -1.0}) {
    if (there && direction < 0.0) break;
    const double drive_rad = direction > 0.0 ? bearing_rad : bearing_rad + std::numbers::pi;
    Link link;
    link.cost = 0.0;
    geometry::Pose2 pose = from;
    if (!there) {
      const geometry::Pose2 there_pose{to_m.x(), to_m.y(), geometry::wrap_angle(drive_rad)};
      if (!free(there_pose, field_.clearance_m(there_pose))) continue;
      auto [move, price] = cheapest_turn(pose, drive_rad);
      if (price == kNever) continue;
      const geometry::Pose2 turned = after(pose, move);
      const double straight = cost(turned, OutlineMove{0.0, direction * length_m});
      if (straight == kNever) continue;
      move.length_m = direction * length_m;
      pose = after(pose, move);
      link.cost += price + straight;
      link.moves.push_back(move);
    }
    if (heading_rad) {
      const auto [move, price] = cheapest_turn(pose, *heading_rad);
      if (price == kNever) continue;
      link.cost += price;
      if (std::fabs(move.turn_rad) > kLeastTurn_rad) link.moves.push_back(move);
    }
    if (link.cost < best.cost) best = std::move(link);
  }
  if (best.cost == kNever) return std::nullopt;
  return best;
}

}  // namespace topogeo::planning
