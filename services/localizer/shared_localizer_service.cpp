#include "shared_localizer_service.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/log.hpp"

#include "pool_options.hpp"
#include "run_counters.hpp"
#include "stop_input.hpp"

namespace topogeo::localizer {

namespace {

using localization::MergeProposal;

/// Twice per status, so that no status shows older figures.
constexpr std::chrono::milliseconds kCounterPeriod{250};

}  // namespace

SharedLocalizerService::SharedLocalizerService(service::Service& service, bool standalone)
    : service_(service),
      pool_(service.participant(), service.loop(), pool_options(service),
            [&service](std::string_view reason, std::string_view detail) {
              service.status().fault(reason, detail);
            }),
      watched_(service, pool_),
      merges_(service, [this] { schedule(); }),
      trajectory_(service),
      poses_(service.advertise<msg::LivePose>()),
      ends_out_(service.advertise<msg::StreamEnd>()) {
  const localization::OdometryNoise& noise = service.setup().config.config.localizer.odometry;
  robots_.emplace(service.robot_id(), Robot{.live = LivePoseEstimate(noise)});
  for (const std::string& robot : service.setup().options.other_robots) {
    robots_.emplace(robot, Robot{.live = LivePoseEstimate(noise)});
  }
  service.subscribe<msg::LocalMap>([this](const msg::LocalMap& map) { on_map(map); },
                                   {.team = true, .main_input = true});
  service.subscribe<msg::Odometry>(
      [this](const msg::Odometry& odometry) {
        const std::string robot = odometry.robot_id().to_string();
        robots_.at(robot).live.set_odometry(odometry.stamp_ns(), odometry.sequence_number(),
                                            service::from_msg(odometry.T_odom_robot()),
                                            odometry.odometry_epoch());
        send_pose(robot);
      },
      {.team = true});
  service.subscribe<msg::TrackedPose>(
      [this](const msg::TrackedPose& pose) {
        robots_.at(pose.robot_id().to_string())
            .live.set_tracked(service::from_msg(pose.stop()), service::from_msg(pose));
      },
      {.team = true});
  service.subscribe<msg::StreamEnd>([this](const msg::StreamEnd& end) { on_stream_end(end); },
                                    {.team = true});
  // A reader that connects when no odometry arrives any more gets the last poses, too.
  service.loop().on_event([this](const messaging::Event& event) {
    if (event.kind != messaging::EventKind::kMatched || event.topic != messaging::kLivePose) return;
    for (const auto& [robot, state] : robots_) send_pose(robot);
  });
  service.loop().add_timer(kCounterPeriod, [this] { set_pool_counters(pool_, service_.status()); });
  if (standalone) {
    resume({});
  } else {
    resume_.emplace(service, [this](SharedResumeFrom from) { resume(std::move(from)); });
  }
}

void SharedLocalizerService::resume(SharedResumeFrom from) {
  map_.emplace(service_.setup().config.config.localizer, watched_, from.map);
  for (const storage::RefusedMerge& refused : from.refused_merges) {
    map_->remember_refused(refused.stop, refused.other);
  }
  if (from.map) {
    // Place of each robot when the map was stored, if its session continues.
    for (const topomap::LocalMap& last : from.map->maps) {
      const auto robot = robots_.find(last.robot_id);
      if (robot == robots_.end()) continue;
      robot->second.queue.start_after(last.stop);
      robot->second.odometry.start_after(last);
    }
    spdlog::info("resuming with a map of {} stops", from.map->maps.size());
  }
  if (!from.stops.empty()) spdlog::info("adding {} stops again", from.stops.size());
  std::set<std::uint64_t> begun;
  for (StopQueue::MapPointer& map : from.stops) {
    const auto robot = robots_.find(map->robot_id);
    if (robot == robots_.end()) continue;
    // Earlier stops are in the map, or not needed any more.
    if (begun.insert(map->stop.session).second && map->stop.number > 0) {
      robot->second.queue.start_after({map->stop.session, map->stop.number - 1});
    }
    robot->second.queue.add(std::move(map));
  }
  ready_ = true;
  service_.status().wait_for("local maps");
  if (from.map) publish(true);
  schedule();
}

void SharedLocalizerService::on_map(const msg::LocalMap& message) {
  StopQueue& queue = robots_.at(message.robot_id().to_string()).queue;
  if (add_stop(service_, message, finished_, queue)) schedule();
}

void SharedLocalizerService::on_stream_end(const msg::StreamEnd& message) {
  if (message.stage() != msg::kStageLocalMapper) return;
  robots_.at(message.robot_id().to_string()).queue.end_at(message.count());
  schedule();
}

void SharedLocalizerService::send_pose(const std::string& robot) {
  const LivePoseEstimate& estimate = robots_.at(robot).live;
  const std::optional<PoseOfNow> now = estimate.now();
  if (!now) return;
  service::LivePose live;
  live.stamp_ns = now->stamp_ns;
  live.sequence = now->sequence;
  live.status = map_->status(robot);
  live.mode = msg::kModeMapping;
  live.T_map_robot = now->T_map_robot.T_a_b;
  live.covariance = now->T_map_robot.covariance;
  live.last_stop = estimate.stop_pose().stop;
  live.trajectory_version = trajectory_.version();
  // A pose that cannot be sent now would be outdated later.
  if (!poses_.write(service::to_msg(live, robot))) {
    service_.status().add_drops("pose not sent");
  }
}

// --- the work

void SharedLocalizerService::schedule() {
  if (scheduled_) return;
  scheduled_ = true;  // until work() has ended: handlers run while it waits for results
  service_.loop().post([this] { work(); });
}

void SharedLocalizerService::work() {
  scheduled_ = ready_;
  if (!ready_) return;
  try {
    answer_merges();
    while (step_all()) answer_merges();
    const bool all_over = std::ranges::all_of(
        robots_, [](const auto& robot) { return robot.second.queue.finished(); });
    if (!finished_ && all_over) finish();
  } catch (const Stopped& stopped) {
    spdlog::debug("{}", stopped.what());
    service_.loop().stop();
  }
  scheduled_ = false;
}

bool SharedLocalizerService::step_all() {
  bool any = false;
  for (auto& [robot, state] : robots_) {
    if (service::Service::stopping()) throw Stopped();
    const StopQueue::MapPointer map = state.queue.take();
    if (!map) continue;
    any = true;
    stamp_ns_ = std::max(stamp_ns_, map->stamp_ns);
    map_->add(state.odometry.add(map));
    state.live.set_stop(map);
    publish(false);
    count();
  }
  return any;
}

void SharedLocalizerService::answer_merges() {
  merges_.carry_out(
      [this](std::uint32_t number, bool accepted) -> CommandAnswer {
        try {
          if (accepted) {
            map_->accept(number);
          } else {
            map_->refuse(number);
          }
        } catch (const std::invalid_argument& error) {
          return {false, error.what()};
        }
        publish(false);
        count();
        return {true, accepted ? "the maps are merged" : "the maps stay separate"};
      },
      stamp_ns_);
}

void SharedLocalizerService::finish() {
  service_.status().set_state(msg::kServiceRunning, "matching revisited places");
  map_->finish();
  finished_ = true;
  publish(true);
  count();
  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), stamp_ns_, 0);
  end.stage(msg::kStageLocalizer);
  const std::size_t stops = map_->trajectory().stops.size();
  end.count(stops);
  end.last_id(stops == 0 ? 0 : stops - 1);
  end.version(trajectory_.version());
  if (!service_.send(ends_out_, end, "stream end")) return;
  std::string apart;
  if (map_->stops_apart() > 0) {
    apart = fmt::format("{} stops have not joined the map", map_->stops_apart());
    spdlog::warn("{}", apart);
  }
  service_.status().set_state(msg::kServiceFinished, apart);
}

void SharedLocalizerService::publish(bool whole) {
  const topomap::Trajectory trajectory = map_->trajectory();
  for (auto& [robot, state] : robots_) {
    if (const auto last = map_->last_stop(robot)) state.live.correct(*last);
  }
  if (!trajectory_.publish(*map_, trajectory, stamp_ns_, whole)) throw Stopped();
  merges_.publish(map_->proposals(), stamp_ns_);
  for (const auto& [robot, state] : robots_) send_pose(robot);
}

void SharedLocalizerService::count() {
  messaging::StatusPublisher& status = service_.status();
  std::size_t stops = 0;
  std::string waiting;
  for (const auto& [robot, state] : robots_) {
    stops += state.queue.taken();
    if (state.queue.taken() > 0 && !map_->joined(robot)) {
      waiting += (waiting.empty() ? "not in the map yet: " : ", ") + robot;
    }
  }
  for (const MergeProposal& proposal : map_->proposals()) {
    if (proposal.state != MergeProposal::State::kOpen) continue;
    waiting += fmt::format("{}merge {} of {} with {} is proposed: topogeo store accept {}",
                           waiting.empty() ? "" : "; ", proposal.number, proposal.robot,
                           proposal.other_robot, proposal.number);
  }
  if (!finished_) status.set_state(msg::kServiceRunning, waiting);
  const auto set = [&status](const std::string& name, std::size_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  set("local_maps", stops);
  set("stops", stops);
  set("stops_in_map", map_->trajectory().stops.size());
  set("stops_apart", map_->stops_apart());
  set("merge_proposals", map_->proposals().size());
  set_slam_counters(*map_, trajectory_.closures(), status);
}

}  // namespace topogeo::localizer
