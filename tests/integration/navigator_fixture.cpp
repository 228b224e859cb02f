#include "navigator_fixture.hpp"

#include <algorithm>
#include <csignal>
#include <future>
#include <variant>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/hybrid_map_messages.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/version.hpp"

#include "join.hpp"

namespace topogeo::test {
namespace {

using Clock = std::chrono::steady_clock;
using Info = messaging::SampleInfo;

constexpr std::chrono::milliseconds kMove{20};
constexpr std::int64_t kLongestMotion_ns = 200'000'000;
constexpr std::int64_t kScanPeriod_ns = 100'000'000;
constexpr std::uint64_t kMapVersion = 3;

world::World room() {
  return world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml");
}

simulation::RobotOptions robot_options() {
  simulation::RobotOptions options;
  options.acceleration_m_per_s2 = 1.5;
  options.angular_acceleration_rad_per_s2 = 4.0;
  options.odometry = {.range_scale_error = 0.0,
                      .range_sigma_m_per_sqrt_m = 0.0,
                      .heading_drift_rad_per_m = 0.0,
                      .heading_sigma_rad_per_sqrt_m = 0.0,
                      .turn_sigma_rad_per_sqrt_rad = 0.0};
  return options;
}

planning::HybridMap make_map() {
  // The same map that receivers build from the message.
  const planning::FreeSpace space(planning::grid_of(pipeline::drawing_of(room())),
                                  {.min_pocket_m2 = planning::kPocket_m2});
  return {space, planning::zones_by_width(space), {}};
}

std::uint64_t count_of(std::string_view reason, const std::vector<msg::FaultCount>& counts) {
  for (const msg::FaultCount& one : counts) {
    if (reason == one.reason().c_str()) return one.count();
  }
  return 0;
}

}  // namespace

NavigatorOnRobot::NavigatorOnRobot()
    : robot_(room(), robot_options()),
      map_(make_map()),
      participant_(join(domain_, kPartition)),
      poses_(participant_),
      goals_(participant_),
      routes_(participant_),
      tiles_(participant_),
      maps_(participant_),
      odometry_(participant_),
      scans_(participant_),
      bases_(participant_),
      base_orders_(participant_),
      command_reader_(participant_),
      status_reader_(participant_),
      service_reader_(participant_),
      goal_reader_(participant_) {
  loop_.add<msg::MotionCommand>(command_reader_,
                                [this](const msg::MotionCommand& command, const Info&) {
                                  command_ = command;
                                  ++commands_;
                                  command_end_ = Clock::now() + std::chrono::milliseconds(300);
                                });
  loop_.add<msg::NavigatorStatus>(status_reader_,
                                  [this](const msg::NavigatorStatus& status, const Info& info) {
                                    status_ = status;
                                    navigator_writer_ = info.writer;
                                  });
  loop_.add<msg::ServiceStatus>(service_reader_,
                                [this](const msg::ServiceStatus& status, const Info&) {
                                  if (status.service() == "navigator") service_status_ = status;
                                });
  loop_.add<msg::Goal>(goal_reader_, [this](const msg::Goal& goal, const Info&) { answer(goal); });
  loop_.add_timer(kMove, [this] { move(); });
}

void NavigatorOnRobot::start() {
  const service::HybridMapMessages messages =
      service::to_messages(map_, "robot", stamp_ns(), kMapVersion);
  for (const msg::GridTile& tile : messages.tiles) ASSERT_TRUE(tiles_.write(tile));
  ASSERT_TRUE(maps_.write(messages.summary));
  status_.reset();
  service_status_.reset();
  const messaging::Handle previous = navigator_writer_;
  std::vector<std::string> words = {"--domain", domain_, "--partition", kPartition};
  if (!memory_.empty()) words.insert(words.end(), {"--memory", memory_.string()});
  navigator_ = std::make_unique<Program>(scratch_, "navigator", words);
  ASSERT_TRUE(wait_for("the navigator to have map and sensors", [&] {
    return status_ && navigator_writer_ != previous && scans_.matched() > 0 &&
           poses_.matched() > 0 &&
           (base_reports_ || base_orders_.connected_with(navigator_writer_)) &&
           (!goals_ || goals_->connected_with(navigator_writer_)) && routes_.matched() > 0 &&
           counter("map_version") == static_cast<double>(kMapVersion);
  })) << navigator_->err();
}

void NavigatorOnRobot::pretend_planner() {
  planner_.emplace(
      participant_, loop_,
      messaging::ServiceIdentity{"planner", "", "robot", std::string(support::kVersion)});
  planner_->set_state(msg::kServiceRunning);
}

std::int64_t NavigatorOnRobot::stamp_ns() const {
  constexpr std::int64_t kSomeDay_ns = 1'000'000'000'000;
  return kSomeDay_ns + std::chrono::nanoseconds(Clock::now() - start_).count();
}

/// Moves the world by the time passed, so it is as late as this process. After a longer pause of
/// this process the robot has stood still for the rest: the commands in between were not obeyed.
void NavigatorOnRobot::move() {
  const std::int64_t now_ns = stamp_ns();
  if (moved_ns_ == 0) moved_ns_ = now_ns;
  simulation::Velocity velocity;
  if (command_ && Clock::now() < command_end_) {
    velocity = {command_->linear_mps(), command_->angular_radps()};
  }
  robot_.step(velocity,
              static_cast<double>(std::min(now_ns - moved_ns_, kLongestMotion_ns)) * 1e-9);
  moved_ns_ = now_ns;
  msg::Odometry odometry;
  messaging::set_header(odometry, robot_id_, now_ns, sent_++);
  odometry.T_odom_robot(service::to_msg(between(T_odom_start_, robot_.T_odom_robot())));
  odometry.odometry_epoch(odometry_epoch_);
  odometry.linear_mps(robot_.velocity().linear_m_per_s);
  odometry.angular_radps(robot_.velocity().angular_rad_per_s);
  static_cast<void>(odometry_.write(odometry));
  if (now_ns < scan_due_ns_) return;
  scan_due_ns_ = now_ns + kScanPeriod_ns;
  sense();
}

void NavigatorOnRobot::sense() {
  scan::Scan scan;
  scan.sequence = sent_;
  scan.stamp_ns = moved_ns_;
  const simulation::BeamPattern& beams = robot_.options().beams;
  scan.angle_min_rad = beams.angle_min_rad;
  scan.angle_step_rad = beams.angle_step_rad;
  scan.ranges_m = robot_.scan();
  scan.T_odom_robot = between(T_odom_start_, robot_.T_odom_robot());
  scan.odometry_epoch = odometry_epoch_;
  static_cast<void>(scans_.write(service::to_msg(scan, robot_id_)));

  service::LivePose pose;
  pose.stamp_ns = moved_ns_;
  pose.sequence = sent_;
  pose.status = {static_cast<localization::LocalizationState>(pose_state_), 0.9};
  pose.T_map_robot = robot_.T_world_robot();
  pose.covariance = 1e-4 * Eigen::Matrix3d::Identity();
  if (poses_come_) static_cast<void>(poses_.write(service::to_msg(pose, robot_id_)));

  if (!base_reports_) return;
  msg::BaseStatus base;
  messaging::set_header(base, robot_id_, moved_ns_, sent_);
  base.state(rolls() ? msg::kBaseMoving : msg::kBaseReady);
  base.commands_taken(true);
  base.stands(!rolls());
  static_cast<void>(bases_.write(base));
}

/// Answers like a planner.
void NavigatorOnRobot::answer(const msg::Goal& message) {
  const service::Goal goal = service::from_msg(message);
  if (goal.kind != msg::kGoalPosition && goal.kind != msg::kGoalPlace) return;
  const geometry::Pose2& T_map_robot = robot_.T_world_robot();
  const planning::HybridRoute found =
      planning::HybridPlanner(map_).plan(T_map_robot.position_m(), goal.target);
  msg::Route route = service::to_msg(found, T_map_robot.theta_rad, goal.heading_rad);
  messaging::set_header(route, "robot", stamp_ns(), sent_++);
  route.goal_id(goal.goal_id);
  route.map_version(kMapVersion);
  ASSERT_TRUE(routes_.write(route));
}

void NavigatorOnRobot::send_goal(std::uint64_t id, const Eigen::Vector2d& target_m) {
  service::Goal goal;
  goal.goal_id = id;
  goal.client_id = "test";
  goal.kind = msg::kGoalPosition;
  goal.target = target_m;
  ASSERT_TRUE(goals_->write(service::to_msg(goal, "robot", stamp_ns(), sent_++)));
}

void NavigatorOnRobot::send_order(messaging::Writer<msg::Goal>& client, msg::GoalKind kind,
                                  std::uint64_t id) {
  service::Goal order;
  order.goal_id = id;
  order.client_id = "test";
  order.kind = kind;
  ASSERT_TRUE(client.write(service::to_msg(order, "robot", stamp_ns(), sent_++)));
}

void NavigatorOnRobot::send_base_order(msg::BaseCommandKind kind, std::uint64_t stop) {
  msg::BaseCommand order;
  messaging::set_header(order, "robot", stamp_ns(), sent_++);
  messaging::set_client_id(order, "test");
  order.kind(kind);
  order.stop_count(stop);
  ASSERT_TRUE(base_orders_.write(order));
}

void NavigatorOnRobot::restart() {
  navigator_->send_signal(SIGKILL);
  ASSERT_EQ(wait_for_end(*navigator_), 128 + SIGKILL);
  start();
}

void NavigatorOnRobot::expect_silence() {
  constexpr std::uint64_t kNoGoal = 99;
  const std::uint64_t before = drops("other goal");
  send_order(msg::kGoalCancel, kNoGoal);
  ASSERT_TRUE(wait_for("the order to be dropped", [&] { return drops("other goal") > before; }));
}

int NavigatorOnRobot::wait_for_end(Program& program) {
  std::future<int> end = std::async(std::launch::async, [&] { return program.wait(); });
  while (end.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
    loop_.run_for(std::chrono::milliseconds(5));
  }
  return end.get();
}

std::uint64_t NavigatorOnRobot::drops(std::string_view reason) const {
  return service_status_ ? count_of(reason, service_status_->drops()) : 0;
}

std::uint64_t NavigatorOnRobot::faults(std::string_view reason) const {
  return service_status_ ? count_of(reason, service_status_->faults()) : 0;
}

double NavigatorOnRobot::counter(std::string_view name) const {
  if (!service_status_) return 0.0;
  for (const msg::Counter& counter : service_status_->counters()) {
    if (counter.name() == std::string(name)) return counter.value();
  }
  return 0.0;
}

}  // namespace topogeo::test
