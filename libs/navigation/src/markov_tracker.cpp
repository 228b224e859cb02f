#include "topogeo/navigation/markov_tracker.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::navigation {
namespace {

MarkovTrackerConfig checked_tracker(const MarkovTrackerConfig& config) {
  check(config);
  return config;
}

markov::ObstacleCells cells_of(const planning::OccupancyGrid& grid, double cell_m) {
  std::vector<std::uint8_t> occupied;
  occupied.reserve(grid.frame().size());
  for (const planning::CellState state : grid.cells()) {
    occupied.push_back(state == planning::CellState::kFree ? 0 : 1);
  }
  markov::CellsView view;
  view.width = grid.frame().columns;
  view.height = grid.frame().rows;
  view.resolution_m = grid.frame().resolution_m;
  view.occupied = occupied;
  const auto a_side = static_cast<int>(std::lround(cell_m / grid.frame().resolution_m));
  return markov::ObstacleCells(view, std::max(1, a_side));
}

std::vector<float> ranges_of(const SonarRound& round) {
  std::vector<float> ranges_m;
  ranges_m.reserve(round.readings.size());
  for (const SonarReading& reading : round.readings) ranges_m.push_back(reading.range_m);
  return ranges_m;
}

}  // namespace

SonarRound laser_round(const ScanPoints& scan, double step_rad) {
  if (!(step_rad > 0.0)) throw std::invalid_argument("laser round: step_rad is not above 0");
  constexpr double kOnBeam_rad = 0.01;  // slightly more than the step of a PLS
  const geometry::Pose2 T_laser_robot = inverse(scan.T_robot_laser);
  const auto beams = static_cast<std::size_t>(std::numbers::pi / step_rad + 1e-9) + 1;
  std::vector<double> off_rad(beams, kOnBeam_rad);
  SonarRound round;
  round.stamp_ns = scan.stamp_ns;
  for (std::size_t i = 0; i < beams; ++i) {
    const double bearing_rad = -0.5 * std::numbers::pi + static_cast<double>(i) * step_rad;
    round.readings.push_back(
        {scan.T_robot_laser * geometry::Pose2{0.0, 0.0, bearing_rad}, 0.0, scan::Scan::kNoReturn});
  }
  for (const Eigen::Vector2d& point_m : scan.points_m) {
    const Eigen::Vector2d seen_m = T_laser_robot * point_m;
    const double from_first_rad = geometry::atan2(seen_m.y(), seen_m.x()) + 0.5 * std::numbers::pi;
    const double place = std::round(from_first_rad / step_rad);
    if (place < 0.0 || place >= static_cast<double>(beams)) continue;
    const auto i = static_cast<std::size_t>(place);
    const double beside_rad = std::fabs(from_first_rad - place * step_rad);
    if (beside_rad >= off_rad[i]) continue;
    off_rad[i] = beside_rad;
    round.readings[i].range_m = static_cast<float>(seen_m.norm());
  }
  return round;
}

MarkovTracker::MarkovTracker(const planning::OccupancyGrid& grid, const MarkovTrackerConfig& config)
    : config_(checked_tracker(config)),
      cells_(cells_of(grid, config.cell_m)),
      T_map_grid_(grid.frame().T_map_grid) {}

bool MarkovTracker::start(const geometry::Pose2& T_map_base_station, const SonarRound& readings) {
  std::vector<markov::RangeSensor> sensors;
  sensors.reserve(readings.readings.size());
  for (const SonarReading& reading : readings.readings) {
    sensors.push_back({reading.T_robot_sonar, reading.half_cone_rad});
  }
  if (last_) T_odom_followed_ = last_->T_odom_robot;
  corrected_m_ = 0.0;
  if (config_.grid == MarkovGrid::kPoses) {
    poses_ = std::make_unique<markov::PoseLocalizer>(config_.poses, cells_, std::move(sensors),
                                                     config_.markov.sonar.max_range_m,
                                                     inverse(T_map_grid_) * T_map_base_station);
    reason_ = poses_->reason();
    if (!reason_.empty()) {
      poses_.reset();
      return false;
    }
    T_odom_heard_ = T_odom_followed_;
    poses_->perceive(ranges_of(readings));
    return true;
  }
  localizer_.emplace(config_.markov, cells_, std::move(sensors));
  const auto report =
      localizer_->initialize(inverse(T_map_grid_) * T_map_base_station, ranges_of(readings));
  reason_ = report.possible ? "" : report.reason;
  if (!report.possible) localizer_.reset();
  return report.possible;
}

void MarkovTracker::add(const OdometrySample& sample) {
  if (last_ && sample.stamp_ns <= last_->stamp_ns) return;
  if (!last_) T_odom_followed_ = sample.T_odom_robot;
  last_ = sample;
  track_.add({sample.stamp_ns, sample.T_odom_robot});
  hear_waiting();
}

void MarkovTracker::follow_poses(const geometry::Pose2& T_odom_robot) {
  poses_->move(between(T_odom_followed_, T_odom_robot));
  T_odom_followed_ = T_odom_robot;
}

void MarkovTracker::hear(const SonarRound& readings) {
  if (!poses_) return;
  waiting_ = readings;
  hear_waiting();
}

void MarkovTracker::hear_waiting() {
  if (!waiting_ || !poses_ || !last_ || waiting_->stamp_ns > last_->stamp_ns) return;
  const SonarRound round = *std::exchange(waiting_, std::nullopt);
  const auto then = track_.at(round.stamp_ns);
  if (!then) return;
  const geometry::Pose2 moved = between(T_odom_heard_, then->T_odom_robot);
  if (moved.position_m().norm() < config_.poses.perceive_every_m &&
      std::fabs(moved.theta_rad) < config_.poses.perceive_every_rad) {
    return;
  }
  follow_poses(then->T_odom_robot);
  T_odom_heard_ = then->T_odom_robot;
  poses_->perceive(ranges_of(round));
  reason_ = poses_->reason();
}

markov::PerceptionReport MarkovTracker::perceive_poses(const SonarRound& readings) {
  if (last_) follow_poses(last_->T_odom_robot);
  T_odom_heard_ = T_odom_followed_;
  const Eigen::Vector2d before_m = poses_->estimate().T_map_robot.position_m();
  poses_->perceive(ranges_of(readings));
  corrected_m_ = (poses_->estimate().T_map_robot.position_m() - before_m).norm();
  reason_ = poses_->reason();
  return {.possible = poses_->located(), .match = {}, .weight = 0.0, .reason = reason_};
}

PoseFix MarkovTracker::pose_fix() const {
  PoseFix fix;
  fix.stamp_ns = last_->stamp_ns;
  fix.tracking = poses_->located();
  fix.state_text = reason_;
  fix.T_map_robot =
      T_map_grid_ * poses_->estimate().T_map_robot * between(T_odom_followed_, last_->T_odom_robot);
  const double turn_rad = T_map_grid_.theta_rad;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(turn_rad).toRotationMatrix();
  fix.covariance = turn * poses_->estimate().covariance * turn.transpose();
  return fix;
}

void MarkovTracker::follow(const markov::Move& move) {
  const auto report = localizer_->move(move);
  reason_ = report.possible ? "" : report.reason;
}

void MarkovTracker::primitive_done() {
  if (poses_ && last_) follow_poses(last_->T_odom_robot);
  if (!localizer_ || !last_) return;
  constexpr double kLeast_m = 1e-6;
  const geometry::Pose2 step = between(T_odom_followed_, last_->T_odom_robot);
  T_odom_followed_ = last_->T_odom_robot;
  const auto turn = [&](double angle_rad) {
    if (angle_rad == 0.0) return;
    follow({angle_rad > 0.0 ? markov::MoveKind::kTurnLeft : markov::MoveKind::kTurnRight,
            std::fabs(angle_rad)});
  };
  double heading_rad = 0.0;
  if (step.position_m().norm() > kLeast_m) {
    heading_rad = geometry::atan2(step.y_m, step.x_m);
    turn(heading_rad);
    follow({markov::MoveKind::kAdvance, step.position_m().norm()});
  }
  turn(geometry::wrap_angle(step.theta_rad - heading_rad));
}

markov::PerceptionReport MarkovTracker::perceive(const SonarRound& readings) {
  if (!started()) throw std::runtime_error("markov tracker: perceive() before start()");
  if (poses_) return perceive_poses(readings);
  primitive_done();
  auto report = localizer_->perceive(ranges_of(readings));
  reason_ = report.possible ? "" : report.reason;
  const Eigen::Vector2d before_m = localizer_->expected().position_m();
  localizer_->accept_estimate();
  corrected_m_ = (localizer_->expected().position_m() - before_m).norm();
  return report;
}

std::optional<PoseFix> MarkovTracker::fix() const {
  if (poses_ && last_) return pose_fix();
  if (!localizer_ || !last_) return std::nullopt;
  PoseFix fix;
  fix.stamp_ns = last_->stamp_ns;
  const auto estimate = localizer_->estimate();
  fix.tracking = estimate.has_value();
  fix.state_text = reason_;
  // Without contrary readings the expected pose counts: with the printed movement model alone the
  // most probable cell runs ahead.
  fix.T_map_robot =
      T_map_grid_ * localizer_->expected() * between(T_odom_followed_, last_->T_odom_robot);
  const double within_m = cells_.cell_m() / std::sqrt(12.0);
  const double spread_m = estimate ? estimate->spread_m : 0.0;
  const double variance_m2 = within_m * within_m + 0.5 * spread_m * spread_m;
  fix.covariance = Eigen::Vector3d(variance_m2, variance_m2,
                                   config_.heading_sigma_rad * config_.heading_sigma_rad)
                       .asDiagonal();
  return fix;
}

std::optional<markov::ReturnMoves> MarkovTracker::return_moves(
    const geometry::Pose2& T_map_route) const {
  if (!localizer_) return std::nullopt;
  return localizer_->relocalization_moves(inverse(T_map_grid_) * T_map_route);
}

}  // namespace topogeo::navigation
