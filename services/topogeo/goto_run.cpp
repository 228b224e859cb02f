#include "goto_run.hpp"

#include <algorithm>
#include <utility>

#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/planning/place_names.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {
namespace {

constexpr double kStart_s = 120.0;  // for the services to start and the robot to find its place
constexpr double kCallOff_s = 5.0;  // for the robot to stop
/// A tick that comes later shows that this program did not run: it waits for nobody.
constexpr double kLongestTick_s = 1.0;

}  // namespace

GotoRun::GotoRun(const RunOptions& options)
    : options_(options),
      since_s_(support::monotonic_s()),
      last_tick_s_(since_s_),
      run_(options),
      truth_(run_.participant(), run_.loop(), options.job.robot_id),
      poses_(run_.participant()),
      session_(run_.participant(), run_.loop(), options.job.robot_id, *options.goal) {
  run_.loop().add<msg::LivePose>(poses_,
                                 [this](const msg::LivePose& pose, const messaging::SampleInfo&) {
                                   if (pose.robot_id() == options_.job.robot_id.c_str())
                                     on_pose(pose);
                                 });
  ServiceRun::Hooks hooks;
  hooks.on_tick = [this] { tick(); };
  hooks.on_first_signal = [this] { call_off(); };
  hooks.log = [this](const std::string& line) { session_.progress().print("topogeo: " + line); };
  run_.start(options_, std::move(hooks));
}

GotoResult GotoRun::run() {
  run_.run();
  session_.progress().finish();
  result_.failure = run_.failure();
  result_.signal_number = result_.arrived ? 0 : run_.signal_number();
  result_.status = session_.client().status();
  if (const auto& route = session_.client().route()) {
    result_.goal_m = Eigen::Vector2d(route->points().back().x_m(), route->points().back().y_m());
  }
  if (!truth_.poses().empty()) {
    const geometry::Pose2 T_world_map = truth_.poses().front().pose * inverse(T_map_start());
    result_.truth = truth_.poses();
    for (topomap::StampedPose& pose : result_.truth) {
      pose.pose = geometry::between(T_world_map, pose.pose);
    }
    result_.collisions = truth_.last().collisions();
    result_.run_into = truth_.last().run_into();
  }
  static_cast<void>(run_.stop(true));
  return std::move(result_);
}

geometry::Pose2 GotoRun::T_map_start() {
  const auto map = session_.client().map();
  if (!options_.station || !map) return {};
  const planning::Place* station = planning::find_base_station(map->places(), *options_.station);
  if (station == nullptr) return {};
  return {station->position_m.x(), station->position_m.y(),
          station->station_heading_rad.value_or(0.0)};
}

void GotoRun::on_pose(const msg::LivePose& pose) {
  pose_ = pose;
  if (pose.state() != msg::kStateTracking) return;
  result_.estimated.push_back(
      {pose.sequence_number(), pose.stamp_ns(), service::from_msg(pose.T_map_robot())});
}

void GotoRun::tick() {
  const double now_s = support::monotonic_s();
  const double passed_s = std::min(now_s - std::exchange(last_tick_s_, now_s), kLongestTick_s);
  if (run_.too_busy().empty()) waited_s_ += passed_s;
  switch (phase_) {
    case Phase::kWaiting:
      wait_for_start();
      break;
    case Phase::kDriving:
      drive();
      break;
    case Phase::kCallingOff:
      if (session_.client().stands() || support::monotonic_s() - since_s_ > kCallOff_s) {
        run_.loop().stop();
      }
      break;
  }
}

std::string GotoRun::waits_for() {
  const std::string missing = session_.client().missing();
  if (!missing.empty()) return "the services";
  if (!session_.client().map()) return "the map";
  if (truth_.poses().empty()) return "the simulated robot";
  if (!pose_) return "the first pose";
  if (options_.goal->look_around || pose_->state() == msg::kStateTracking) return {};
  return fmt::format(
      "the robot to find its place ({})",
      localization::to_string(static_cast<localization::LocalizationState>(pose_->state())));
}

void GotoRun::wait_for_start() {
  const std::string what = waits_for();
  if (what.empty()) {
    phase_ = Phase::kDriving;
    since_s_ = support::monotonic_s();
    session_.send();
    return;
  }
  if (what != reported_) session_.progress().print("waiting for " + what);
  reported_ = what;
  if (waited_s_ < kStart_s) return;
  run_.fail(fmt::format("{:.0f} s have passed, and it still waits for {}", kStart_s, what));
}

void GotoRun::drive() {
  session_.tick();
  const std::optional<supervision::GoalEnd> end = session_.end();
  if (!end) return;
  result_.drive_s = support::monotonic_s() - since_s_;
  result_.arrived = end->arrived;
  if (end->arrived) {
    run_.loop().stop();
    return;
  }
  run_.note_failure(end->reason);
  call_off();
}

void GotoRun::call_off() {
  if (phase_ == Phase::kCallingOff) return;
  phase_ = Phase::kCallingOff;
  since_s_ = support::monotonic_s();
  session_.client().cancel();
}

}  // namespace topogeo::cli
