#include "run/goto_drive.hpp"

#include <utility>

#include "topogeo/planning/place_names.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/slam/state_monitor.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::cli {

GotoDrive::GotoDrive(const RunOptions& options)
    : options_(options),
      phases_(support::monotonic_s()),
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

GotoResult GotoDrive::run() {
  run_.run();
  session_.progress().finish();
  result_.failure = run_.failure();
  result_.arrived = phases_.has_arrived();
  result_.drive_s = phases_.drive_s();
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

geometry::Pose2 GotoDrive::T_map_start() {
  const auto map = session_.client().map();
  if (!options_.station || !map) return {};
  const planning::Place* station = planning::find_base_station(map->places(), *options_.station);
  if (station == nullptr) return {};
  return {station->position_m.x(), station->position_m.y(),
          station->station_heading_rad.value_or(0.0)};
}

void GotoDrive::on_pose(const msg::LivePose& pose) {
  pose_ = pose;
  if (pose.state() != msg::kStateTracking) return;
  result_.estimated.push_back(
      {pose.sequence_number(), pose.stamp_ns(), service::from_msg(pose.T_map_robot())});
}

void GotoDrive::tick() {
  if (phases_.is_driving()) session_.tick();
  const supervision::GotoView view{phases_.is_waiting() ? waits_for() : "", run_.too_busy(),
                                   session_.end(), session_.client().stands()};
  switch (phases_.step(support::monotonic_s(), view)) {
    case supervision::GotoAction::kNone:
      report_wait(view.waits_for);
      break;
    case supervision::GotoAction::kSendGoal:
      session_.send();
      break;
    case supervision::GotoAction::kCallOff:
      run_.note_failure(phases_.failure());
      session_.client().cancel();
      break;
    case supervision::GotoAction::kFail:
      run_.fail(phases_.failure());
      break;
    case supervision::GotoAction::kEnd:
      run_.loop().stop();
      break;
  }
}

void GotoDrive::report_wait(const std::string& what) {
  if (!what.empty() && what != reported_) session_.progress().print("waiting for " + what);
  reported_ = what;
}

std::string GotoDrive::waits_for() {
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

void GotoDrive::call_off() {
  if (phases_.call_off()) session_.client().cancel();
}

}  // namespace topogeo::cli
