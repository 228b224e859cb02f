#include "navigator_service.hpp"

#include <chrono>
#include <exception>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/geometry/reaction_times.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/navigation_conversions.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::navigator {

using navigation::HaltReason;
using navigation::NavigatorState;
using std::chrono::milliseconds;

namespace {

constexpr milliseconds kPeriod{50};        // a scan takes 40 to 100 ms: faster finds nothing new
constexpr milliseconds kMapPeriod{100};    // tiles of an update come one by one
constexpr milliseconds kLastCommand{200};  // time for the gateway to get the last command
constexpr std::int64_t kStopTail_ns = 1'000'000'000;       // repeats zeros: one may be lost
constexpr std::int64_t kStatusPeriod_ns = 200'000'000;     // as fast as a person reads it
constexpr std::int64_t kBlockagesPeriod_ns = 200'000'000;  // planning takes some milliseconds

/// Whether the navigator owns the base in this state, even at a standstill.
bool holds_the_base(NavigatorState state) {
  return state == NavigatorState::kDriving || state == NavigatorState::kRelocalizing ||
         state == NavigatorState::kBlocked;
}

bool differs(const navigation::NavigatorStatus& a, const navigation::NavigatorStatus& b) {
  return a.state != b.state || a.reason != b.reason || a.goal_id != b.goal_id ||
         a.busy_machine != b.busy_machine;
}

}  // namespace

NavigatorService::NavigatorService(service::Service& service, const std::filesystem::path& memory,
                                   const std::filesystem::path& stop_memory)
    : service_(service),
      clock_(support::wall_clock_ns() - support::monotonic_ns()),
      navigator_(service.setup().config.config.navigator),
      memory_(memory),
      stop_(service, stop_memory, navigator_, support::monotonic_ns(), [this] { tick(); }),
      live_map_(service),
      commands_(service.advertise<msg::MotionCommand>()),
      statuses_(service.advertise<msg::NavigatorStatus>()),
      blockages_(service.advertise<msg::Blockages>()) {
  const navigation::NavigatorConfig& config = service.setup().config.config.navigator;
  if (config.pose_source == navigation::PoseSource::kMarkov) {
    poses_.emplace(service.advertise<msg::LivePose>());
  }
  resume();
  listen_to_orders();
  listen_to_sensors();
  messaging::EventLoop& loop = service_.loop();
  loop.add_timer(kPeriod, [this] { tick(); });
  loop.add_timer(kMapPeriod, [this] { take_map(); });
  for (const char* counter : {"goals", "arrivals", "routes", "commands", "map_version"}) {
    service_.status().set_counter(counter, 0.0);
  }
  service_.status().set_state(msg::kServiceRunning);
}

NavigatorService::~NavigatorService() {
  if (!moving_ && support::monotonic_ns() > command_until_ns_) return;
  try {
    send_command({}, clock_.now_ns(support::monotonic_ns()));
    static_cast<void>(commands_.wait_for_acknowledgments(kLastCommand));
  } catch (const std::exception& error) {
    spdlog::error("the last command was not sent: {}", error.what());
  }
}

void NavigatorService::resume() {
  const std::optional<RememberedGoal> goal = memory_.load();
  if (!goal) return;
  spdlog::info("resuming goal {}{}{}", goal->order.goal_id, goal->paused ? ", paused" : "",
               goal->stuck ? ", stuck" : "");
  if (!goal->arrived) goal_ = goal->order;
  paused_ = goal->paused;
  restore(*goal, navigator_);
}

void NavigatorService::listen_to_orders() {
  // Orders are of the moment: a volatile reader gets none that a client gave before it was
  // connected with this process, so no ended goal comes back and no old resume undoes a pause.
  service_.subscribe<msg::Goal>([this](const msg::Goal& goal) { on_goal(goal); },
                                {.role = "request"});
  service_.subscribe<msg::Route>([this](const msg::Route& route) { on_route(route); });
}

void NavigatorService::listen_to_sensors() {
  service_.subscribe<msg::LivePose>(
      [this](const msg::LivePose& pose) {
        if (pose.mode() == msg::kModeMarkov) return;  // the navigator's own pose
        // Validate the whole message first: the stamp of a rejected one must not count.
        const navigation::PoseFix fix = service::to_pose_fix(service::from_msg(pose));
        note_arrival(navigation::TimedInput::kPose, fix.stamp_ns);
        if (is_newer(Source::kPose, fix.stamp_ns)) navigator_.add(fix);
      },
      {.main_input = true});
  service_.subscribe<msg::Odometry>([this](const msg::Odometry& odometry) {
    const navigation::OdometrySample sample = service::odometry_from_msg(odometry);
    if (!is_of_epoch(odometry.odometry_epoch())) return;
    note_stamp(sample.stamp_ns);
    note_arrival(navigation::TimedInput::kOdometry, sample.stamp_ns);
    if (is_newer(Source::kOdometry, sample.stamp_ns)) navigator_.add(sample);
  });
  service_.subscribe<msg::Scan>([this](const msg::Scan& scan) { on_scan(scan); });
  service_.subscribe<msg::Sonar>([this](const msg::Sonar& sonar) {
    const navigation::SonarRound round = service::sonar_from_msg(sonar);
    note_arrival(navigation::TimedInput::kSonar, round.stamp_ns);
    if (is_newer(Source::kSonar, round.stamp_ns)) navigator_.add(round);
  });
  service_.subscribe<msg::BaseStatus>([this](const msg::BaseStatus& base) {
    const auto status = service::base_from_msg(base);
    if (!is_newer(Source::kBase, status.stamp_ns)) return;
    navigator_.add(status);
    stop_.take(base);
  });
  service_.subscribe<msg::LaserStatus>([this](const msg::LaserStatus& laser) {
    if (!is_newer(Source::kLaser, laser.stamp_ns())) return;
    navigator_.add(
        navigation::LaserFields{laser.stamp_ns(), laser.warning_field(), laser.protective_field()});
  });
}

bool NavigatorService::is_of_epoch(std::uint64_t epoch) {
  // Longer than any message is under way. Afterwards its source speaks again, and the other one was
  // a stranger.
  constexpr std::int64_t kLate_ns = 2'000'000'000;
  if (epoch == epoch_) return true;
  const std::int64_t now_ns = support::monotonic_ns();
  if (epoch == previous_epoch_ && now_ns - epoch_since_ns_ < kLate_ns) {
    service_.status().add_drops("odometry of before");
    return false;
  }
  previous_epoch_ = std::exchange(epoch_, epoch);
  epoch_since_ns_ = now_ns;
  // The first epoch of this process ends nothing.
  if (previous_epoch_) begin_again("odometry restarted", "waiting for a pose");
  return true;
}

bool NavigatorService::is_newer(Source source, std::int64_t stamp_ns) {
  // A stamp from the future would make all later ones old and stop the robot for good.
  constexpr std::int64_t kAhead_ns = 1'000'000'000;
  const bool sets_clock = source == Source::kScan || source == Source::kOdometry;
  if (!sets_clock) {
    const std::int64_t now_ns = clock_.now_ns(support::monotonic_ns());
    if (stamp_ns > kAhead_ns && stamp_ns - kAhead_ns > now_ns) {
      service_.status().add_drops("from the future");
      return false;
    }
  }
  std::optional<std::int64_t>& last_ns = last_ns_.at(static_cast<std::size_t>(source));
  if (last_ns && stamp_ns <= *last_ns) {
    // Odometry messages may be older than the odometry that came with a scan.
    if (source != Source::kOdometry) service_.status().add_drops("not newer");
    return false;
  }
  last_ns = stamp_ns;
  return true;
}

void NavigatorService::note_stamp(std::int64_t stamp_ns) {
  clock_.observe(stamp_ns, support::monotonic_ns());
}

void NavigatorService::note_arrival(navigation::TimedInput input, std::int64_t stamp_ns) {
  navigator_.note_arrival(input, stamp_ns, clock_.now_ns(support::monotonic_ns()));
}

void NavigatorService::on_scan(const msg::Scan& message) {
  const navigation::ScanPoints points = service::to_scan_points(
      service::from_msg(message), service_.setup().config.config.local_mapper.T_robot_laser);
  if (!is_of_epoch(message.odometry_epoch())) return;
  note_stamp(points.stamp_ns);
  note_arrival(navigation::TimedInput::kScan, points.stamp_ns);
  if (!is_newer(Source::kScan, points.stamp_ns)) return;
  if (is_newer(Source::kOdometry, points.stamp_ns)) {
    navigator_.add(navigation::OdometrySample{points.stamp_ns, points.T_odom_robot});
  }
  navigator_.add(points);
}

void NavigatorService::on_goal(const msg::Goal& message) {
  const service::Goal goal = service::from_msg(message);
  const bool change = goal.kind == msg::kGoalPause || goal.kind == msg::kGoalResume;
  const bool order = change || goal.kind == msg::kGoalCancel;
  // A pause may name the goal just reached: a list of goals then waits there.
  const navigation::NavigatorStatus& now = navigator_.status();
  const bool stays = change && now.state == NavigatorState::kArrived;
  const std::uint64_t named = goal_ ? goal_->goal_id : (stays ? now.goal_id : 0);
  if (order && goal.goal_id != 0 && goal.goal_id != named) {
    service_.status().add_drops("other goal");
    return;
  }
  switch (goal.kind) {
    case msg::kGoalCancel:
      spdlog::info("{} cancels the goal", goal.client_id);
      navigator_.cancel();
      goal_.reset();
      break;
    case msg::kGoalPause:
      spdlog::info("{} pauses", goal.client_id);
      navigator_.pause();
      paused_ = true;
      break;
    case msg::kGoalResume:
      spdlog::info("{} resumes", goal.client_id);
      navigator_.resume();
      paused_ = false;
      break;
    default:
      spdlog::info("goal {} of {}", goal.goal_id, goal.client_id);
      service_.status().add_to_counter("goals");
      goal_ = navigation::GoalOrder{goal.goal_id, goal.look_around};
      paused_ = false;
      navigator_.set_goal(*goal_);
      // The planner may have answered before the goal arrived here.
      if (route_ && route_->goal_id() == goal.goal_id) use_route(*route_);
      break;
  }
  tick();
}

void NavigatorService::on_route(const msg::Route& message) {
  use_route(message);
  service_.status().add_to_counter("routes");
  route_ = message;
}

void NavigatorService::use_route(const msg::Route& message) {
  take_map();
  const bool same_map = message.map_version() == live_map_.version();
  navigator_.set_route(service::route_plan_from_msg(message, same_map ? map_.get() : nullptr));
}

void NavigatorService::take_map() {
  std::shared_ptr<const planning::HybridMap> map;
  try {
    map = live_map_.map();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid hybrid map", error.what());
    return;
  }
  if (!map || map == map_) return;  // the rest of the update is under way
  map_ = std::move(map);
  navigator_.set_map(map_, live_map_.version());
  service_.status().set_counter("map_version", static_cast<double>(live_map_.version()));
}

void NavigatorService::tick() {
  const std::int64_t now_ns = clock_.now_ns(support::monotonic_ns());
  if (clock_.take_set_back()) {
    begin_again("time set back", "the sensors' stamps are older than before");
  }
  stop_.check(support::monotonic_ns());
  navigator_.set_machine({service_.cpu().is_short_now(), service_.cpu().timer_delay_s()});
  const geometry::Velocity velocity = navigator_.step(now_ns);
  command(velocity, now_ns);
  publish_pose();
  publish_status(now_ns);
  publish_blockages(now_ns);
  remember();
}

void NavigatorService::remember() {
  memory_.store(to_remember(goal_, paused_, navigator_));
}

void NavigatorService::publish_pose() {
  const std::optional<navigation::PoseFix>& pose = navigator_.markov_pose();
  if (!poses_ || !pose || pose->stamp_ns == published_pose_ns_) return;
  published_pose_ns_ = pose->stamp_ns;
  const msg::LivePose message =
      service::to_msg(service::to_live_pose(*pose, poses_sent_), service_.robot_id());
  if (poses_->write(message)) {
    ++poses_sent_;
  } else {
    service_.status().fault("send blocked", "pose");
  }
}

void NavigatorService::begin_again(const std::string& fault, const std::string& detail) {
  last_ns_.fill(std::nullopt);
  const bool stuck = navigator_.is_stuck();
  const navigation::NavigatorStatus before = navigator_.status();
  // The pose by Markov localization is the navigator's own: the base station is not where it is.
  const std::optional<navigation::PoseFix> place = navigator_.markov_pose();
  navigator_ = navigation::Navigator(service_.setup().config.config.navigator);
  if (place && place->tracking) navigator_.add(*place);
  if (map_) navigator_.set_map(map_, live_map_.version());
  stop_.apply();
  if (!goal_) {
    if (before.state == NavigatorState::kArrived) stay_arrived(before);
    return;
  }
  service_.status().fault(fault, detail);
  navigator_.set_goal(*goal_);
  if (paused_) navigator_.pause();
  if (stuck) navigator_.stay_stuck();
  if (route_ && route_->goal_id() == goal_->goal_id) use_route(*route_);
}

void NavigatorService::stay_arrived(const navigation::NavigatorStatus& before) {
  navigator_.set_goal({before.goal_id, false});
  navigator_.stay_arrived(before.message);
  if (paused_) navigator_.pause();
}

void NavigatorService::command(const geometry::Velocity& velocity, std::int64_t now_ns) {
  const std::int64_t steady_ns = support::monotonic_ns();
  if (velocity != geometry::Velocity{} || holds_the_base(navigator_.status().state)) {
    command_until_ns_ = steady_ns + kStopTail_ns;
  }
  if (steady_ns < command_until_ns_) send_command(velocity, now_ns);
}

void NavigatorService::send_command(const geometry::Velocity& velocity, std::int64_t now_ns) {
  msg::MotionCommand message;
  messaging::set_header(message, service_.robot_id(), now_ns, commands_sent_);
  message.linear_mps(velocity.linear_m_per_s);
  message.angular_radps(velocity.angular_rad_per_s);
  message.valid_for_s(geometry::kCommandValid_s);
  // The next command makes up for a lost one; without any, the gateway halts the base.
  if (!commands_.write(message)) {
    service_.status().fault("send blocked", "motion command");
    return;
  }
  moving_ = velocity != geometry::Velocity{};
  ++commands_sent_;
}

void NavigatorService::publish_status(std::int64_t now_ns) {
  const navigation::NavigatorStatus& status = navigator_.status();
  const std::int64_t steady_ns = support::monotonic_ns();
  const std::string stop = status.reason == HaltReason::kBaseNotReady ? "" : stop_.reason();
  const bool changed = !published_ || differs(status, *published_) || stop != shown_stop_;
  if (!changed && steady_ns < status_due_ns_) return;
  status_due_ns_ = steady_ns + kStatusPeriod_ns;
  if (changed) {
    std::string text(navigation::describe(status.state));
    for (const std::string& part : {status.message, stop}) text += part.empty() ? "" : ": " + part;
    spdlog::info("{}", text);
    if (status.state == NavigatorState::kArrived && goal_) {
      service_.status().add_to_counter("arrivals");
      goal_.reset();
    }
    remember();  // stored before others see the change
    service_.status().set_state(msg::kServiceRunning, text);
  }
  published_ = status;
  shown_stop_ = stop;
  service_.status().set_counter("commands", static_cast<double>(commands_sent_));
  if (statuses_.write(service::to_msg(status, service_.robot_id(), now_ns, statuses_sent_))) {
    ++statuses_sent_;
  } else {
    service_.status().fault("send blocked", "navigator status");
  }
}

void NavigatorService::publish_blockages(std::int64_t now_ns) {
  const navigation::BlockageReport& report = navigator_.blockages();
  const std::int64_t steady_ns = support::monotonic_ns();
  if (published_blockages_ == report.version || steady_ns < blockages_due_ns_) return;
  blockages_due_ns_ = steady_ns + kBlockagesPeriod_ns;
  published_blockages_ = report.version;
  try {
    if (service_.send(blockages_,
                      service::to_msg(report, service_.robot_id(), now_ns, blockages_sent_),
                      "blockages")) {
      ++blockages_sent_;
    }
  } catch (const std::invalid_argument& error) {
    service_.status().fault("blockages not sent", error.what());
  }
}

}  // namespace topogeo::navigator
