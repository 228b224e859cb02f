#include "arrival_run.hpp"

#include <cmath>
#include <numbers>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/support/seed.hpp"

#include "closed_loop.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;

constexpr double kDegree = std::numbers::pi / 180.0;

/// An initial pose with the error of one given by hand.
Pose2 told(const Pose2& T_map_robot, std::uint64_t seed) {
  constexpr double kSigma_m = 0.1;
  constexpr double kSigma_rad = 5.0 * kDegree;
  support::Random random(support::derive_seed(seed, "told pose", {}));
  return {T_map_robot.x_m + kSigma_m * random.normal(),
          T_map_robot.y_m + kSigma_m * random.normal(),
          geometry::wrap_angle(T_map_robot.theta_rad + kSigma_rad * random.normal())};
}

ClosedLoopConfig loop_config(const ArrivalConfig& config, const ArrivalTask& task) {
  ClosedLoopConfig loop;
  loop.system = config.system;
  loop.navigator = config.navigator;
  loop.robot = b21_robot(task.T_world_start, config.system.local_mapper.T_robot_laser,
                         config.wheels, config.slip_per_m, task.seed);
  return loop;
}

void keep(const ClosedLoop& loop, ArrivalRecord& record) {
  TracePoint point;
  point.time_s = loop.time_s();
  point.T_world_robot = loop.robot().T_world_robot();
  if (loop.pose()) point.T_map_robot = loop.pose()->T_map_robot;
  point.status = loop.navigator().status();
  record.trace.push_back(point);
}

ArrivalResult score(const MappedFloor& floor, const ArrivalTask& task, const ClosedLoop& loop) {
  const navigation::NavigatorStatus& status = loop.navigator().status();
  const Pose2& truth = loop.robot().T_world_robot();
  const Pose2 T_map_truth = geometry::inverse(floor.T_world_map_at(truth.position_m())) * truth;
  ArrivalResult result;
  result.arrived = status.state == navigation::NavigatorState::kArrived;
  result.error_m = (T_map_truth.position_m() - task.T_map_goal.position_m()).norm();
  result.heading_error_rad =
      std::fabs(geometry::wrap_angle(T_map_truth.theta_rad - task.T_map_goal.theta_rad));
  result.world_error_m =
      (floor.T_world_map() * task.T_map_goal.position_m() - truth.position_m()).norm();
  if (loop.pose()) {
    result.pose_error_m = (loop.pose()->T_map_robot.position_m() - T_map_truth.position_m()).norm();
  }
  result.collisions = loop.robot().collisions();
  result.run_into = loop.robot().run_into();
  result.path_m = loop.robot().path_m();
  result.detours = status.detours;
  result.guard_stops = status.guard_stops;
  result.plans = loop.plans().size();
  result.end = std::string(navigation::describe(status.state)) + ", " +
               std::string(navigation::describe(status.reason)) + ": " + status.message;
  return result;
}

}  // namespace

bool ArrivalResult::good() const {
  constexpr double kNear_m = 0.1;
  constexpr double kNear_rad = 5.0 * kDegree;
  return arrived && error_m <= kNear_m && heading_error_rad <= kNear_rad && collisions == 0;
}

ArrivalResult run_arrival(const MappedFloor& floor, const ArrivalConfig& config,
                          const ArrivalTask& task, ArrivalRecord* record) {
  localization::InProcessPool pool;
  localization::MapTracker tracker(config.system.localizer, floor.stored, pool);
  if (config.pose_given) {
    tracker.set_pose(told(task.T_map_start, task.seed), localization::given_pose_covariance());
  }
  ClosedLoop loop(task.world, loop_config(config, task), tracker);
  loop.set_map(floor.map, 1);
  loop.set_goal({{1, true}, task.T_map_goal.position_m(), task.T_map_goal.theta_rad});
  const double start_s = loop.time_s();
  constexpr std::uint64_t kTrace = 20;  // ticks
  std::uint64_t ticks = 0;
  double arrived_s = -1.0;          // negative: not yet
  constexpr double kRolls_s = 1.0;  // until the wheels have stopped for certain
  while (loop.time_s() - start_s < config.longest_s) {
    loop.tick();
    if (record != nullptr && ticks++ % kTrace == 0) keep(loop, *record);
    if (loop.navigator().status().state != navigation::NavigatorState::kArrived) {
      arrived_s = -1.0;
    } else if (arrived_s < 0.0) {
      arrived_s = loop.time_s();
    } else if (loop.time_s() - arrived_s > kRolls_s) {
      break;
    }
  }
  if (record != nullptr) {
    for (const navigation::RoutePlan& plan : loop.plans())
      record->routes_m.push_back(plan.points_m);
  }
  ArrivalResult result = score(floor, task, loop);
  result.time_s = (arrived_s < 0.0 ? loop.time_s() : arrived_s) - start_s;
  return result;
}

}  // namespace topogeo::bench
