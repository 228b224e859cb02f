#include "localizer_service.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/log.hpp"

#include "pool_options.hpp"
#include "run_counters.hpp"
#include "run_summary.hpp"
#include "stop_input.hpp"

namespace topogeo::localizer {

namespace {

/// At least this many stops of a robot in a finished map stay visible, about an hour; all do when a
/// log is replayed or a map store stores them.
constexpr std::size_t kShownStops = 2048;
/// Twice per status, so that no status shows older figures.
constexpr std::chrono::milliseconds kCountPeriod{250};

localization::MapToUse map_to_use(const service::Service& service,
                                  const LocalizerOptions& options) {
  using localization::MapToUse;
  if (options.map) {
    return {pipeline::load_stored_map(*options.map), MapToUse::Use::kLocalize,
            options.initial_pose};
  }
  return {pipeline::stored_map(*pipeline::load_map_to_continue(
              *options.continued, service.setup().config.config, service.robot_id())),
          MapToUse::Use::kExtendMap, options.initial_pose};
}

localization::SlamSession make_slam(const service::Service& service,
                                    const LocalizerOptions& options, localization::MatchPool& pool,
                                    localization::GraphOptimizer& optimizer,
                                    std::optional<PoseMemory>& memory) {
  const localization::LocalizerConfig& config = service.setup().config.config.localizer;
  if (!options.map && !options.continued) return {config, pool, &optimizer};
  try {
    const localization::MapToUse stored = map_to_use(service, options);
    if (options.map && options.memory) memory.emplace(*options.memory, *stored.map);
    return {config, pool, &optimizer, stored};
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

}  // namespace

LocalizerService::LocalizerService(service::Service& service, const LocalizerOptions& options)
    : service_(service),
      options_(options),
      pool_(service.participant(), service.loop(), pool_options(service),
            [&service](std::string_view reason, std::string_view detail) {
              service.status().fault(reason, detail);
            }),
      watched_(service, pool_),
      commands_(service, [this] { schedule(); }),
      trajectory_(service),
      poses_(service.advertise<msg::LivePose>()),
      summaries_(service.advertise<msg::RunSummary>()),
      ends_out_(service.advertise<msg::StreamEnd>()),
      live_(service.setup().config.config.localizer.odometry) {
  service.subscribe<msg::LocalMap>([this](const msg::LocalMap& map) { on_map(map); },
                                   {.main_input = true});
  service.subscribe<msg::Odometry>(
      [this](const msg::Odometry& odometry) { on_odometry(odometry); });
  service.subscribe<msg::TrackedPose>([this](const msg::TrackedPose& pose) {
    live_.set_tracked(service::from_msg(pose.stop()), service::from_msg(pose));
  });
  service.subscribe<msg::StreamEnd>([this](const msg::StreamEnd& end) { on_stream_end(end); });
  // A reader that connects when no odometry arrives any more, after a log, gets the last pose, too.
  service.loop().on_event([this](const messaging::Event& event) {
    if (event.kind == messaging::EventKind::kMatched && event.topic == messaging::kLivePose) {
      send_pose();
    }
  });
  service.loop().add_timer(kCountPeriod, [this] { set_pool_counters(pool_, service_.status()); });
  if (!options.standalone) {
    missing_.emplace(service, queue_, options.replay || !options.map, [this] { schedule(); });
    service.loop().add_timer(kCountPeriod, [this] {
      if (ready_ && !finished_) missing_->check();
    });
  }
  slam_.emplace(make_slam(service, options, watched_, optimizer_, memory_));
  recall();
  if (options.map) {
    service.subscribe<msg::StoredMap>([this](const msg::StoredMap& stored) {
      stops_are_stored_ = stored.session() != msg::kNothingIsStored;
    });
    if (options.csv) table_.emplace(*options.csv);
  }
  count();
  if (options.standalone || options.map || options.continued) {
    resume({});
  } else {
    resume_.emplace(service, options.replay, [this](ResumeFrom from) { resume(std::move(from)); });
  }
}

void LocalizerService::resume(ResumeFrom from) {
  if (from.map) {
    using Use = localization::MapToUse::Use;
    const topomap::LocalMap& last = from.map->maps.back();
    slam_.emplace(
        service_.setup().config.config.localizer, watched_, &optimizer_,
        localization::MapToUse{
            from.map, from.resumes_session ? Use::kResumeSession : Use::kExtendMap, std::nullopt});
    if (from.resumes_session) {
      queue_.start_after(last.stop);
      odometry_.start_after(last);
      live_.set_stop(std::make_shared<const topomap::LocalMap>(last));
      live_.correct(from.map->trajectory.stops.back());
    }
    spdlog::info("resuming with a map of {} stops", from.map->maps.size());
  } else if (!from.stops.empty()) {
    known_stops_ = from.stops.size();
    spdlog::info("adding {} stops again", known_stops_);
  }
  for (StopQueue::MapPointer& map : from.stops) queue_.add(std::move(map));
  ready_ = true;
  service_.status().wait_for("local maps");
  schedule();
}

void LocalizerService::on_map(const msg::LocalMap& message) {
  if (add_stop(service_, message, finished_, queue_)) schedule();
}

void LocalizerService::on_stream_end(const msg::StreamEnd& message) {
  if (message.stage() != msg::kStageLocalMapper) return;
  queue_.end_at(message.count());
  schedule();
}

void LocalizerService::on_odometry(const msg::Odometry& message) {
  // A log that is read again repeats old readings; a robot's stamps may go back with its clock.
  if (options_.replay && live_.has_newer(message.stamp_ns(), message.odometry_epoch())) return;
  live_.set_odometry(message.stamp_ns(), message.sequence_number(),
                     service::from_msg(message.T_odom_robot()), message.odometry_epoch());
  send_pose();
}

void LocalizerService::send_pose() {
  const std::optional<PoseOfNow> now = live_.now();
  if (!now) return;
  service::LivePose live;
  live.stamp_ns = now->stamp_ns;
  live.sequence = now->sequence;
  live.status = (*slam_)->status();
  live.mode = slam_->mapping() ? msg::kModeMapping : msg::kModeLocalization;
  live.T_map_robot = now->T_map_robot.T_a_b;
  live.covariance = now->T_map_robot.covariance;
  live.last_stop = live_.stop_pose().stop;
  live.trajectory_version = trajectory_.version();
  // A pose that cannot be sent now would be outdated later.
  if (!poses_.write(service::to_msg(live, service_.robot_id()))) {
    service_.status().add_drops("pose not sent");
  }
}

// --- the work

void LocalizerService::schedule() {
  if (scheduled_) return;
  scheduled_ = true;  // until work() has ended: handlers run while it waits for results
  service_.loop().post([this] { work(); });
}

void LocalizerService::work() {
  scheduled_ = ready_;
  if (!ready_) return;
  try {
    if (!waited_) wait_for_workers();
    carry_out_commands();
    while (const StopQueue::MapPointer map = queue_.take()) {
      if (service::Service::stopping()) throw Stopped();
      step(map);
      carry_out_commands();
    }
    if (!finished_ && queue_.finished()) finish();
  } catch (const Stopped& stopped) {
    spdlog::debug("{}", stopped.what());
    service_.loop().stop();
  }
  scheduled_ = false;
}

void LocalizerService::wait_for_workers() {
  waited_ = true;
  if (options_.wait_workers == 0) return;
  service_.status().wait_for(std::to_string(options_.wait_workers) + " workers");
  const std::size_t workers = pool_.wait_for_workers(
      options_.wait_workers, std::chrono::duration_cast<std::chrono::nanoseconds>(
                                 std::chrono::duration<double>(options_.wait_s)));
  if (workers < options_.wait_workers) {
    spdlog::warn("{} of {} workers joined within {} s, continuing with them", workers,
                 options_.wait_workers, options_.wait_s);
  }
  service_.status().wait_for("local maps");
}

void LocalizerService::step(const StopQueue::MapPointer& map) {
  if (service_.status().state() != msg::kServiceRunning) {
    service_.status().set_state(msg::kServiceRunning);
  }
  (*slam_)->add(odometry_.add(map));
  if (queue_.taken() < known_stops_) return;  // no pose is published before the last of these stops
  live_.set_stop(map);
  last_map_ = map;
  remember();
  if (localization::MapTracker* tracker = slam_->map_tracker()) {
    if (table_) table_->add({tracker->stops(), tracker->added_stops()});
    if (!options_.replay && !stops_are_stored_) tracker->forget_stops(kShownStops);
  }
  publish(false);
  send_pose();  // shows a correction at once, also when no odometry arrives any more
  count();
}

void LocalizerService::recall() {
  if (!memory_) return;
  const std::optional<RememberedPlace> last = memory_->load();
  if (!last) return;
  slam_->map_tracker()->start_after(last->place);
  // Match that stop once more, if the local mapper still has it.
  if (last->stop.number > 0) queue_.start_after({last->stop.session, last->stop.number - 1});
  spdlog::info("resuming at stop {}, the last known place of the robot", last->stop.number);
}

void LocalizerService::remember() const {
  if (!memory_ || !last_map_) return;
  const std::vector<localization::LocalizedStop>& stops = slam_->map_tracker()->stops();
  if (stops.empty() || !localization::located(stops.back().status.state)) {
    memory_->forget();
    return;
  }
  const localization::LocalizedStop& last = stops.back();
  memory_->store(
      {last_map_->stop,
       {{last.T_map_robot, last.covariance}, last_map_->T_odom_robot, last_map_->odometry_epoch}});
}

std::size_t LocalizerService::stops_in_map() const {
  if (slam_->mapping_session() != nullptr) return slam_->mapping_session()->maps().size();
  return slam_->map_tracker() != nullptr ? slam_->map_tracker()->stops().size() : queue_.taken();
}

void LocalizerService::finish() {
  service_.status().set_state(msg::kServiceRunning, slam_->map_tracker() == nullptr
                                                        ? "matching revisited places"
                                                        : "localizing");
  (*slam_)->finish();
  if (table_) table_->finish({slam_->map_tracker()->stops(), slam_->map_tracker()->added_stops()});
  finished_ = true;
  publish(true);
  send_pose();
  count();
  const RunParts parts{**slam_, slam_->map_tracker(),
                       options_.continued ? slam_->mapping_session() : nullptr, pool_.counts()};
  const msg::RunSummary summary =
      make_run_summary(parts, service_.robot_id(), live_.stop_pose().stamp_ns);
  if (!service_.send(summaries_, summary, "run summary")) return;
  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), live_.stop_pose().stamp_ns, 0);
  end.stage(msg::kStageLocalizer);
  const std::size_t stops = stops_in_map();
  end.count(stops);
  end.last_id(stops == 0 ? 0 : stops - 1);
  end.version(trajectory_.version());
  if (!service_.send(ends_out_, end, "stream end")) return;
  const localization::SlamCounts counts = (*slam_)->counts();
  spdlog::info("{} stops, {} match tasks, {} loop closures", queue_.taken(), counts.tasks,
               trajectory_.closures());
  std::string message;
  if (slam_->mapping_session() != nullptr) {
    message = pipeline::continuation_message(*slam_->mapping_session());
    if (!message.empty()) spdlog::warn("{}", message);
  }
  service_.status().set_state(msg::kServiceFinished, message);
}

void LocalizerService::publish(bool whole) {
  const topomap::Trajectory trajectory = (*slam_)->trajectory();
  if (const auto last = (*slam_)->last_stop()) live_.correct(*last);
  if (!trajectory_.publish(**slam_, trajectory, live_.stop_pose().stamp_ns, whole)) throw Stopped();
}

// --- commands

void LocalizerService::carry_out_commands() {
  commands_.carry_out(
      [this](const service::LocalizationCommand& command) {
        CommandAnswer answer = carry_out(command);
        remember();
        send_pose();
        count();
        return answer;
      },
      live_.stop_pose().stamp_ns);
}

CommandAnswer LocalizerService::carry_out(const service::LocalizationCommand& command) {
  const CommandMoment now{finished_, stops_in_map(), live_.T_stop_robot()};
  CommandAnswer answer = localizer::carry_out(command, now, *slam_);
  if (answer.accepted && command.kind == msg::kCommandSetPose && live_.has_stop()) {
    live_.correct(stop_pose(command, now), command.covariance);
  }
  return answer;
}

// --- counters

void LocalizerService::count() {
  messaging::StatusPublisher& status = service_.status();
  const auto set = [&status](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  status.set_queue("local maps", queue_.waiting());
  set("local_maps", queue_.taken());
  set("stops", queue_.taken());
  set_slam_counters(**slam_, trajectory_.closures(), status);
  if (const localization::MappingSession* session = slam_->mapping_session()) {
    if (options_.continued) {
      for (const auto& [name, value] : pipeline::continuation_counts(*session)) set(name, value);
    }
    set("stops_in_map", stops_in_map());
  }
  if (const auto* in_map = slam_->map_tracker()) {
    for (const auto& [name, value] : pipeline::localization_counts(*in_map)) set(name, value);
  }
  set_pool_counters(pool_, status);
  report_need();
}

void LocalizerService::report_need() {
  // One stop does not distinguish places that look alike, so a robot that stands may wait for ever.
  if (queue_.taken() == 0) return;
  const bool lost = !finished_ && slam_->map_tracker() != nullptr &&
                    !localization::located((*slam_)->status().state);
  service_.status().set_waits_for(lost ? "the robot to drive on, or its pose to be set" : "");
}

}  // namespace topogeo::localizer
