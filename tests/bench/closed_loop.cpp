#include "closed_loop.hpp"

#include <utility>

#include "topogeo/geometry/portable_math.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/scan/scan.hpp"

namespace topogeo::bench {
namespace {

constexpr std::int64_t kControl_ns = 50'000'000;
constexpr std::int64_t kOdometry_ns = 100'000'000;
constexpr std::int64_t kScan_ns = 100'000'000;
constexpr std::int64_t kSonar_ns = 200'000'000;
constexpr std::int64_t kStart_ns = 1'000'000'000;

std::int64_t nanoseconds(double time_s) {
  return static_cast<std::int64_t>(time_s * 1e9);
}

}  // namespace

ClosedLoop::ClosedLoop(world::World world, const ClosedLoopConfig& config, localization::Slam& slam)
    : config_(config),
      robot_(std::move(world), config.robot),
      slam_(slam),
      mapper_(config.system.local_mapper, "robot"),
      navigator_(config.navigator),
      now_ns_(kStart_ns) {}

void ClosedLoop::set_map(std::shared_ptr<const planning::HybridMap> map, std::uint64_t version) {
  map_ = std::move(map);
  map_version_ = version;
  planner_.emplace(*map_, config_.planner);
  navigator_.set_map(map_, version);
}

void ClosedLoop::set_goal(const LoopGoal& goal) {
  goal_ = goal;
  plans_.clear();
  navigator_.set_goal(goal.order);
}

void ClosedLoop::tick() {
  made_stop_ = false;
  while (!commands_.empty() && commands_.front().from_ns <= now_ns_) {
    obeyed_ = commands_.front().velocity;
    commands_.pop_front();
  }
  robot_.step(obeyed_, 1e-9 * static_cast<double>(kTick_ns));
  now_ns_ += kTick_ns;
  if (now_ns_ % kOdometry_ns == 0) odometry();
  if (now_ns_ % kSonar_ns == 0) sonar();
  if (now_ns_ % kScan_ns == 0) scan();
  if (now_ns_ % kControl_ns != 0) return;
  plan_if_due();
  commands_.push_back({now_ns_ + nanoseconds(config_.obeys_after_s), navigator_.step(now_ns_)});
}

void ClosedLoop::odometry() {
  navigator_.add(navigation::BaseCondition{now_ns_, true, {}});
  navigator_.add(navigation::OdometrySample{now_ns_, robot_.T_odom_robot()});
  locate();
}

void ClosedLoop::sonar() {
  navigation::SonarRound round;
  round.stamp_ns = now_ns_;
  const std::vector<float> ranges_m = robot_.sonar();
  for (std::size_t i = 0; i < ranges_m.size(); ++i) {
    const devices::SonarMount& mount = robot_.options().sonars.at(i);
    round.readings.push_back({mount.T_robot_sonar, mount.half_cone_rad, ranges_m[i]});
  }
  navigator_.add(round);
}

void ClosedLoop::scan() {
  const simulation::RobotOptions& options = robot_.options();
  scan::Scan scan;
  scan.sequence = scans_++;
  scan.stamp_ns = now_ns_;
  scan.angle_min_rad = options.beams.angle_min_rad;
  scan.angle_step_rad = options.beams.angle_step_rad;
  scan.ranges_m = robot_.scan();
  scan.T_odom_robot = robot_.T_odom_robot();
  navigation::ScanPoints points;
  points.stamp_ns = now_ns_;
  points.T_odom_robot = scan.T_odom_robot;
  points.T_robot_laser = options.T_robot_laser;
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (scan.ranges_m[i] == scan::Scan::kNoReturn) continue;
    const double range_m = scan.ranges_m[i];
    const geometry::SinCos angle =
        geometry::sincos(scan.angle_min_rad + static_cast<double>(i) * scan.angle_step_rad);
    points.points_m.push_back(options.T_robot_laser *
                              Eigen::Vector2d(range_m * angle.cos, range_m * angle.sin));
  }
  navigator_.add(points);
  if (std::optional<topomap::LocalMap> map = mapper_.add(scan)) {
    local_maps_.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    slam_.add(local_maps_.back());
    made_stop_ = true;
    locate();
  }
}

// Publishes the pose like the localizer service.
void ClosedLoop::locate() {
  const std::optional<topomap::StopPose> stop = slam_.last_stop();
  if (local_maps_.empty() || !stop) return;
  const localization::UncertainPose now = localization::live_pose(
      {stop->T_map_robot, stop->covariance}, local_maps_.back()->T_odom_robot,
      mapper_.last_tracked(), robot_.T_odom_robot(), config_.system.localizer.odometry);
  const localization::LocalizationState state = slam_.status().state;
  located_ = localization::located(state);
  pose_.emplace();
  pose_->stamp_ns = now_ns_;
  pose_->T_map_robot = now.T_a_b;
  pose_->covariance = now.covariance;
  pose_->tracking = state == localization::LocalizationState::kTracking;
  pose_->located = located_;
  pose_->state_text = localization::to_string(state);
  if (config_.mapping) pose_->covariance.setZero();
  navigator_.add(*pose_);
}

// The planner's part: plans a route to the goal once there are a map and a pose, and again when the
// map or an obstruction has changed.
void ClosedLoop::plan_if_due() {
  if (!goal_ || !planner_ || !located_) return;
  const std::uint64_t blockages = navigator_.blockages().version;
  if (!plans_.empty() && plans_.back().map_version == map_version_ &&
      plans_.back().blockages_version == blockages) {
    return;
  }
  plans_.push_back(plan());
  navigator_.set_route(plans_.back());
}

navigation::RoutePlan ClosedLoop::plan() const {
  planning::Closures closed;
  for (const Eigen::Vector2d& point_m : navigator_.blockages().points_m) {
    if (const auto cell = map_->frame().cell_of(point_m)) closed.cells.push_back(*cell);
  }
  const planning::HybridRoute route =
      planner_->plan(pose_->T_map_robot.position_m(), goal_->target, closed);
  navigation::RoutePlan plan;
  plan.goal_id = goal_->order.goal_id;
  plan.map_version = map_version_;
  plan.blockages_version = navigator_.blockages().version;
  plan.found = route.found();
  plan.reason = route.reason;
  plan.points_m = route.points_m;
  for (const std::uint32_t node : route.nodes) {
    plan.nodes_m.push_back(map_->nodes().at(node).position_m);
  }
  plan.heading_rad = goal_->heading_rad;
  return plan;
}

}  // namespace topogeo::bench
