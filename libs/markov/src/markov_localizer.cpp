#include "topogeo/markov/markov_localizer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/support/check_range.hpp"

namespace topogeo::markov {
namespace {

void check_pose(const std::string& name, const geometry::Pose2& pose) {
  support::check_range(name + ".x_m", pose.x_m, -1e6, 1e6);
  support::check_range(name + ".y_m", pose.y_m, -1e6, 1e6);
  support::check_range(name + ".theta_rad", pose.theta_rad, -1e5, 1e5);
}

void check_move(const Move& move) {
  constexpr double kMost = 1000.0;
  if (move.kind == MoveKind::kAdvance) {
    support::check_range("advance", move.amount, -kMost, kMost, "m");
  } else {
    support::check_range("turn", move.amount, 0.0, kMost, "rad");
  }
}

std::string cell_text(Cell cell) {
  return "cell (" + std::to_string(cell.x) + ", " + std::to_string(cell.y) + ")";
}

void add_turn(double angle_rad, std::vector<Move>& moves) {
  constexpr double kNone_rad = 1e-9;
  if (angle_rad > kNone_rad) moves.push_back({MoveKind::kTurnLeft, angle_rad});
  if (angle_rad < -kNone_rad) moves.push_back({MoveKind::kTurnRight, -angle_rad});
}

bool meets_obstacle(const ObstacleCells& map, const Eigen::Vector2d& from_m,
                    const Eigen::Vector2d& to_m) {
  // A tenth of a cell: a smaller cut of a corner is within the rounding to cells.
  const int steps = 1 + static_cast<int>((to_m - from_m).norm() / (0.1 * map.cell_m()));
  for (int i = 0; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    if (!map.free(map.cell_of(from_m + part * (to_m - from_m)))) return true;
  }
  return false;
}

}  // namespace

MarkovLocalizer::MarkovLocalizer(const MarkovConfig& config, ObstacleCells map,
                                 std::vector<RangeSensor> sensors)
    : config_((check(config), config)),
      map_(std::move(map)),
      sonar_(std::move(sensors), config.sonar),
      belief_(config.window_cells) {}

void MarkovLocalizer::require_initialized(const char* call) const {
  if (initialized_) return;
  throw std::runtime_error(std::string("MarkovLocalizer: ") + call +
                           " before initialize(): the base station is not known");
}

std::string MarkovLocalizer::nowhere() const {
  return "every free cell of the window around " + cell_text(belief_.centre()) +
         " has probability 0";
}

PerceptionReport MarkovLocalizer::initialize(const geometry::Pose2& T_map_base_station,
                                             std::span<const float> ranges_m) {
  check_pose("base station", T_map_base_station);
  T_map_expected_ = T_map_base_station;
  const Cell cell = map_.cell_of(T_map_base_station.position_m());
  belief_.clear();
  belief_.carry_to(cell);
  free_cells_of_window(map_, cell, belief_.size(), free_);
  initialized_ = true;
  if (!map_.free(cell)) {
    return {.reason = "the base station is in " + cell_text(cell) + ", which is " +
                      (map_.inside(cell) ? "an obstacle" : "outside the map")};
  }
  belief_.set({0, 0}, 1.0);
  return perceive(ranges_m);
}

void MarkovLocalizer::step(const geometry::Pose2& T_map_expected, std::span<const Tap> taps,
                           MovementReport& report) {
  T_map_expected_ = T_map_expected;
  belief_.carry_to(map_.cell_of(T_map_expected.position_m()));
  free_cells_of_window(map_, belief_.centre(), belief_.size(), free_);
  report.kept_share = std::min(report.kept_share, spread(taps, free_, belief_));
  belief_.normalize();
}

/// Applies the motion from start to end in this many steps of the matrix, the last one maybe a
/// part.
void MarkovLocalizer::apply(const geometry::Pose2& T_start_end, const TransitionMatrix& matrix,
                            double heading_rad, double steps, MovementReport& report) {
  constexpr double kNone = 1e-9;  // so that 0.3 m are three steps of 0.1 m
  if (steps <= kNone) return;
  const std::vector<Tap> taps = turned(matrix, config_.transition.sense, heading_rad);
  const geometry::Pose2 T_map_start = T_map_expected_;
  const auto at = [&](double part) {
    return T_map_start * geometry::Pose2{part * T_start_end.x_m, part * T_start_end.y_m,
                                         part * T_start_end.theta_rad};
  };
  const int whole = static_cast<int>(std::floor(steps + kNone));
  const double rest = steps - whole;
  for (int i = 1; i <= whole; ++i) {
    const bool last = i == whole && rest <= kNone;
    step(at(last ? 1.0 : i / steps), taps, report);
  }
  if (rest > kNone) step(at(1.0), part_of(taps, rest), report);
}

MovementReport MarkovLocalizer::move(const Move& move) {
  require_initialized("move()");
  check_move(move);
  const TransitionModel& model = config_.transition;
  const double heading_rad = T_map_expected_.theta_rad;
  const auto steps = [&](double step_size) {
    if (step_size == 0.0) return move.amount == 0.0 ? 0.0 : 1.0;
    return std::abs(move.amount) / step_size;
  };
  MovementReport report;
  switch (move.kind) {
    case MoveKind::kAdvance:
      apply({move.amount, 0.0, 0.0}, model.advance,
            move.amount < 0.0 ? heading_rad + std::numbers::pi : heading_rad,
            steps(model.advance_step_m), report);
      break;
    case MoveKind::kTurnLeft:
      apply({0.0, 0.0, move.amount}, model.left, heading_rad, steps(model.turn_step_rad), report);
      break;
    case MoveKind::kTurnRight:
      apply({0.0, 0.0, -move.amount}, model.right, heading_rad, steps(model.turn_step_rad), report);
      break;
  }
  report.possible = belief_.sum() > 0.0;
  if (!report.possible) report.reason = nowhere();
  return report;
}

PerceptionReport MarkovLocalizer::perceive(std::span<const float> ranges_m) {
  require_initialized("perceive()");
  sonar_.look_around(map_, T_map_expected_, belief_.size());
  std::vector<double> perceptual(belief_.current().size());
  PerceptionReport report;
  report.match = sonar_.compare(ranges_m, perceptual);
  if (report.match.informative) {
    report.weight = report.match.reliability * config_.perceptual_weight;
  }
  if (report.weight > 0.0) {
    belief_.begin_update();
    const std::span<const double> movement = std::as_const(belief_).previous();
    const std::span<double> state = belief_.current();
    for (std::size_t i = 0; i < state.size(); ++i) {
      state[i] = report.weight * perceptual[i] + (1.0 - report.weight) * movement[i];
    }
    belief_.normalize();
  } else if (report.match.compared == 0) {
    report.reason = "no sensor has a reading";
  } else if (!report.match.informative) {
    report.reason = "the readings fit no free cell";
  } else {
    report.reason = "the readings are not reliable at the expected distances";
  }
  report.possible = belief_.sum() > 0.0;
  if (!report.possible) report.reason = nowhere();
  return report;
}

std::optional<Estimate> MarkovLocalizer::estimate() const {
  const int half = belief_.half();
  Cell best{};
  double most = 0.0;
  double entropy = 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double mean_square = 0.0;
  const auto square = [](Cell offset) { return offset.x * offset.x + offset.y * offset.y; };
  for (int y = -half; y <= half; ++y) {
    for (int x = -half; x <= half; ++x) {
      const Cell offset{x, y};
      const double probability = belief_.at(offset);
      if (probability <= 0.0) continue;
      entropy -= probability * geometry::log(probability);
      mean += probability * Eigen::Vector2d{x, y};
      mean_square += probability * square(offset);
      if (probability > most || (probability == most && square(offset) < square(best))) {
        most = probability;
        best = offset;
      }
    }
  }
  if (most <= 0.0) return std::nullopt;
  const double cell_m = map_.cell_m();
  const Cell centre = belief_.centre();
  return Estimate{.T_map_robot = {T_map_expected_.x_m + best.x * cell_m,
                                  T_map_expected_.y_m + best.y * cell_m, T_map_expected_.theta_rad},
                  .cell = {centre.x + best.x, centre.y + best.y},
                  .offset = best,
                  .probability = most,
                  .entropy = std::max(0.0, entropy),
                  .spread_m = cell_m * std::sqrt(std::max(0.0, mean_square - mean.squaredNorm()))};
}

std::optional<ReturnMoves> MarkovLocalizer::relocalization_moves() const {
  return relocalization_moves(T_map_expected_);
}

std::optional<ReturnMoves> MarkovLocalizer::relocalization_moves(
    const geometry::Pose2& T_map_route) const {
  constexpr double kThere_m = 1e-6;
  check_pose("pose of the route", T_map_route);
  const std::optional<Estimate> from = estimate();
  if (!from) return std::nullopt;
  const Eigen::Vector2d vector_m = T_map_route.position_m() - from->T_map_robot.position_m();
  const double heading_rad = from->T_map_robot.theta_rad;
  ReturnMoves back;
  if (vector_m.norm() < kThere_m) {
    add_turn(geometry::wrap_angle(T_map_route.theta_rad - heading_rad), back.moves);
    return back;
  }
  const double bearing_rad = geometry::atan2(vector_m.y(), vector_m.x());
  add_turn(geometry::wrap_angle(bearing_rad - heading_rad), back.moves);
  back.moves.push_back({MoveKind::kAdvance, vector_m.norm()});
  add_turn(geometry::wrap_angle(T_map_route.theta_rad - bearing_rad), back.moves);
  back.blocked = meets_obstacle(map_, from->T_map_robot.position_m(), T_map_route.position_m());
  return back;
}

void MarkovLocalizer::accept_estimate() {
  const std::optional<Estimate> accepted = estimate();
  if (!accepted) return;
  T_map_expected_ = accepted->T_map_robot;
  belief_.recentre(accepted->cell);
  free_cells_of_window(map_, belief_.centre(), belief_.size(), free_);
  belief_.normalize();
}

MovementReport MarkovLocalizer::set_map(ObstacleCells map) {
  if (std::abs(map.cell_m() - map_.cell_m()) > 1e-9) {
    throw std::invalid_argument("map with cells of " + std::to_string(map.cell_m()) +
                                " m, must be " + std::to_string(map_.cell_m()) + " m");
  }
  map_ = std::move(map);
  MovementReport report{.possible = true};
  if (!initialized_) return report;
  belief_.carry_to(map_.cell_of(T_map_expected_.position_m()));
  free_cells_of_window(map_, belief_.centre(), belief_.size(), free_);
  belief_.keep_only(free_);
  report.kept_share = belief_.normalize();
  report.possible = report.kept_share > 0.0;
  if (!report.possible) report.reason = nowhere();
  return report;
}

}  // namespace topogeo::markov
