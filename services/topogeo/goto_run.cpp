#include "goto_run.hpp"

#include <chrono>
#include <iostream>

#include "topogeo/localization/mapping/localization_state.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"

#include "run_supervisor.hpp"

namespace topogeo::cli {
namespace {

constexpr std::chrono::milliseconds kGotoTick{50};
constexpr double kStart_s = 120.0;  // for the services to start and the robot to find its place
constexpr double kCallOff_s = 5.0;  // for the robot to stop

}  // namespace

GotoRun::GotoRun(const RunOptions& options) : GotoRun(options, own_partition()) {}

GotoRun::GotoRun(const RunOptions& options, const std::string& partition)
    : options_(options),
      since_s_(support::monotonic_s()),
      participant_(join(options, partition)),
      truths_(participant_),
      poses_(participant_),
      session_(participant_, loop_, options.job.robot_id, *options.goal),
      signals_([this](int number) { on_signal(number); }),
      services_(options, partition) {
  loop_.add<msg::GroundTruth>(truths_,
                              [this](const msg::GroundTruth& truth, const messaging::SampleInfo&) {
                                if (truth.robot_id() == options_.job.robot_id.c_str()) {
                                  on_truth(truth);
                                }
                              });
  loop_.add<msg::LivePose>(poses_, [this](const msg::LivePose& pose, const messaging::SampleInfo&) {
    if (pose.robot_id() == options_.job.robot_id.c_str()) on_pose(pose);
  });
  loop_.add_timer(kGotoTick, [this] { tick(); });
}

// A second signal stops everything.
void GotoRun::on_signal(int number) {
  if (signal_.exchange(number) == 0) {
    loop_.post([this] { call_off(); });
  } else {
    loop_.stop();
  }
}

GotoResult GotoRun::run() {
  loop_.run();
  session_.progress().finish();
  result_.signal_number = result_.arrived ? 0 : signal_.load();
  result_.status = session_.client().status();
  if (const auto& route = session_.client().route()) {
    result_.goal_m = Eigen::Vector2d(route->points().back().x_m(), route->points().back().y_m());
  }
  stop(services_, loop_, true,
       [](const std::string& text) { std::cerr << "topogeo: " << text << '\n'; });
  services_.wait();
  return std::move(result_);
}

void GotoRun::on_truth(const msg::GroundTruth& truth) {
  const geometry::Pose2 T_world_robot = service::from_msg(truth.T_world_robot());
  if (!T_world_map_) T_world_map_ = T_world_robot;
  result_.truth.push_back(
      {result_.truth.size(), truth.stamp_ns(), geometry::between(*T_world_map_, T_world_robot)});
  result_.collisions = truth.collisions();
  result_.run_into = truth.run_into();
}

void GotoRun::on_pose(const msg::LivePose& pose) {
  pose_ = pose;
  if (pose.state() != msg::kStateTracking) return;
  result_.believed.push_back(
      {pose.sequence_number(), pose.stamp_ns(), service::from_msg(pose.T_map_robot())});
}

void GotoRun::tick() {
  check_deaths();
  switch (phase_) {
    case Phase::kWaiting:
      wait_for_start();
      break;
    case Phase::kDriving:
      drive();
      break;
    case Phase::kCallingOff:
      if (session_.client().stands() || support::monotonic_s() - since_s_ > kCallOff_s)
        loop_.stop();
      break;
  }
}

void GotoRun::check_deaths() {
  while (const std::optional<ServiceGroup::Death> death = services_.next_death()) {
    if (death->is_worker) {
      session_.progress().say("topogeo: " + death->what + "; going on without it");
    } else {
      fail(death->what);
      loop_.stop();
    }
  }
}

std::string GotoRun::waits_for() {
  const std::string missing = session_.client().missing();
  if (!missing.empty()) return "the services";
  if (!session_.client().map()) return "the map";
  if (!T_world_map_) return "the simulated robot";
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
  if (what != told_) session_.progress().say("waiting for " + what);
  told_ = what;
  if (support::monotonic_s() - since_s_ < kStart_s) return;
  fail(fmt::format("{:.0f} s have passed, and it still waits for {}", kStart_s, what));
  loop_.stop();
}

void GotoRun::drive() {
  session_.tick();
  const std::optional<GoalEnd> end = session_.end();
  if (!end) return;
  result_.drive_s = support::monotonic_s() - since_s_;
  result_.arrived = end->arrived;
  if (end->arrived) {
    loop_.stop();
    return;
  }
  fail(end->reason);
  call_off();
}

void GotoRun::call_off() {
  if (phase_ == Phase::kCallingOff) return;
  phase_ = Phase::kCallingOff;
  since_s_ = support::monotonic_s();
  session_.client().cancel();
}

void GotoRun::fail(const std::string& why) {
  if (result_.failure.empty()) result_.failure = why;
}

}  // namespace topogeo::cli
