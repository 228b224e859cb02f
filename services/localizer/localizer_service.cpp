#include "localizer_service.hpp"

#include <algorithm>
#include <stdexcept>

#include "topogeo/localization/matching/match_gate.hpp"
#include "topogeo/localization/tracking/live_pose.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/host.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/version.hpp"

namespace topogeo::localizer {

namespace {

constexpr std::chrono::milliseconds kCountPeriod{250};

/// Different for every process that ever ran, as far as workers can remember.
std::string unique_client_id() {
  const auto start = std::chrono::system_clock::now().time_since_epoch();
  return support::process_name() + "-" +
         std::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(start).count());
}

RemotePoolOptions pool_options(const service::Service& service) {
  RemotePoolOptions options;
  options.robot_id = service.robot_id();
  options.client_id = unique_client_id();
  options.version = support::kVersion;
  options.config_fingerprint = service.setup().config.effective.fingerprint;
  options.stopping = [] { return service::Service::stopping(); };
  return options;
}

ActiveSlam make_slam(const service::Service& service, const LocalizerOptions& options,
                     localization::MatchPool& pool) {
  const pipeline::Config& config = service.setup().config.config;
  if (!options.map && !options.continued) return {config.localizer, pool};
  try {
    if (options.map) {
      return {config.localizer, pool, pipeline::load_stored_map(*options.map),
              ActiveSlam::Use::kLocalize, options.initial_pose};
    }
    const auto document =
        pipeline::load_map_to_continue(*options.continued, config, service.robot_id());
    return {config.localizer, pool, pipeline::stored_map(*document), ActiveSlam::Use::kContinue,
            options.initial_pose};
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

bool same(const std::vector<topomap::LoopClosure>& a, const std::vector<topomap::LoopClosure>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& x, const auto& y) {
    return x.earlier_id == y.earlier_id && x.later_id == y.later_id &&
           x.T_earlier_later == y.T_earlier_later;
  });
}

}  // namespace

LocalizerService::LocalizerService(service::Service& service, const LocalizerOptions& options)
    : service_(service),
      options_(options),
      pool_(service.participant(), service.loop(), pool_options(service),
            [&service](std::string_view reason, std::string_view detail) {
              service.status().fault(reason, detail);
            }),
      localizer_(make_slam(service, options, pool_)),
      commands_(service, [this] { schedule(); }),
      maps_in_(service.participant()),
      odometry_(service.participant()),
      tracked_poses_(service.participant()),
      ends_in_(service.participant()),
      segments_(service.participant()),
      closures_(service.participant()),
      decisions_(service.participant()),
      poses_(service.participant()),
      ends_out_(service.participant()) {
  messaging::EventLoop& loop = service_.loop();
  loop.add<msg::LocalMap>(maps_in_, [this](const msg::LocalMap& message,
                                           const messaging::SampleInfo&) { on_map(message); });
  loop.add<msg::Odometry>(
      odometry_,
      [this](const msg::Odometry& message, const messaging::SampleInfo&) { on_odometry(message); });
  loop.add<msg::TrackedPose>(
      tracked_poses_, [this](const msg::TrackedPose& message, const messaging::SampleInfo&) {
        service_.take(message, "tracked pose", [this](const msg::TrackedPose& pose) {
          tracked_ = {pose.local_map_id(), service::from_msg(pose)};
        });
      });
  loop.add<msg::StreamEnd>(ends_in_,
                           [this](const msg::StreamEnd& message, const messaging::SampleInfo&) {
                             on_stream_end(message);
                           });
  loop.add(segments_);
  loop.add(closures_);
  loop.add(decisions_);
  loop.add(poses_);
  loop.add(ends_out_);
  loop.add_timer(kCountPeriod, [this] { count_pool(); });
  count();
  service_.status().set_state(msg::kServiceWaiting, "for local maps");
  schedule();
}

void LocalizerService::on_map(const msg::LocalMap& message) {
  if (!service_.is_own(message)) return;
  const std::string name = "local map " + std::to_string(message.id());
  if (message.id() < hashes_.size()) {
    // A reader gets a map again when its writer comes back; another map of that id is from
    // another run.
    if (message.content_hash() != hashes_[message.id()]) {
      service_.status().fault("local map of another run", name);
    }
    return;
  }
  if (finished_) {
    service_.status().fault("local map after the end", name);
    return;
  }
  try {
    queue_[message.id()] = std::make_shared<const topomap::LocalMap>(service::from_msg(message));
    schedule();
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid local map", name + ": " + error.what());
  }
}

void LocalizerService::on_stream_end(const msg::StreamEnd& message) {
  if (message.stage() != "local_mapper" || !service_.is_own(message)) return;
  maps_in_stream_ = message.count();
  schedule();
}

void LocalizerService::on_odometry(const msg::Odometry& message) {
  if (!service_.is_own(message)) return;
  try {
    newest_ = {message.stamp_ns(), message.sequence_number(),
               service::from_msg(message.T_odom_robot())};
  } catch (const std::invalid_argument& error) {
    service_.status().fault("invalid odometry", error.what());
    return;
  }
  send_pose();
}

// The pose now, from the corrected pose of the last stop.
void LocalizerService::send_pose() {
  if (!last_map_) return;
  const bool tracked = tracked_ && tracked_->stop == last_map_->id;
  const localization::UncertainPose pose = localization::live_pose(
      {last_stop_.T_map_robot, last_stop_.covariance}, last_map_->T_odom_robot,
      tracked ? &tracked_->scan : nullptr, newest_.T_odom_robot,
      service_.setup().config.config.localizer.odometry);
  service::LivePose live;
  live.stamp_ns = newest_.stamp_ns;
  live.sequence = newest_.sequence;
  live.belief = localizer_->belief();
  live.mode = localizer_.mapping() ? msg::kModeMapping : msg::kModeLocalization;
  live.T_map_robot = pose.T_a_b;
  live.covariance = pose.covariance;
  live.local_map_id = last_stop_.source_id;
  live.trajectory_version = version_;
  // One that cannot be sent now is old by the time it could.
  if (!poses_.write(service::to_msg(live, service_.robot_id()))) {
    service_.status().add_to_counter("poses_not_sent");
  }
}

// --- the work

void LocalizerService::schedule() {
  if (scheduled_) return;
  scheduled_ = true;  // until work() has ended: handlers run while it waits for results
  service_.loop().post([this] { work(); });
}

void LocalizerService::work() {
  try {
    if (!waited_) wait_for_workers();
    carry_out_commands();
    while (!queue_.empty() && queue_.begin()->first == hashes_.size()) {
      if (service::Service::stopping()) throw Stopped();
      const MapPointer map = queue_.begin()->second;
      queue_.erase(queue_.begin());
      step(map);
      carry_out_commands();
    }
    if (!finished_ && maps_in_stream_ && hashes_.size() >= *maps_in_stream_) finish();
  } catch (const Stopped& stopped) {
    spdlog::debug("{}", stopped.what());
    service_.loop().stop();
  }
  scheduled_ = false;
}

void LocalizerService::wait_for_workers() {
  waited_ = true;
  if (options_.wait_workers == 0) return;
  service_.status().set_state(msg::kServiceWaiting,
                              "for " + std::to_string(options_.wait_workers) + " workers");
  const std::size_t workers = pool_.wait_for_workers(
      options_.wait_workers, std::chrono::duration_cast<std::chrono::nanoseconds>(
                                 std::chrono::duration<double>(options_.wait_s)));
  if (workers < options_.wait_workers) {
    spdlog::warn("{} of {} workers came within {} s, going on with them", workers,
                 options_.wait_workers, options_.wait_s);
  }
  service_.status().set_state(msg::kServiceWaiting, "for local maps");
}

void LocalizerService::step(const MapPointer& map) {
  if (service_.status().state() != msg::kServiceRunning) {
    service_.status().set_state(msg::kServiceRunning);
  }
  hashes_.push_back(topomap::content_hash(*map));
  localizer_->add(map);
  last_map_ = map;
  if (map->stamp_ns >= newest_.stamp_ns) {
    newest_ = {map->stamp_ns, map->sequence, map->T_odom_robot};
  }
  publish(false);
  send_pose();  // a correction shows at once, also when no odometry comes any more
  count();
}

std::size_t LocalizerService::stops_in_map() const {
  return localizer_.session() != nullptr ? localizer_.session()->maps().size() : hashes_.size();
}

void LocalizerService::finish() {
  service_.status().set_state(msg::kServiceRunning, localizer_.map_localizer() == nullptr
                                                        ? "matching revisited places"
                                                        : "localizing");
  localizer_->finish();
  if (options_.csv && localizer_.session() == nullptr) {
    support::write_file_atomically(*options_.csv,
                                   pipeline::localization_csv(localizer_.map_localizer()->stops()));
  }
  finished_ = true;
  publish(true);
  send_pose();
  count();
  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), last_stop_.stamp_ns, 0);
  messaging::set_text(end.stage(), "localizer", "stage");
  const std::size_t stops = stops_in_map();
  end.count(stops);
  end.last_id(stops == 0 ? 0 : stops - 1);
  end.version(version_);
  if (!service_.send(ends_out_, end, "stream end")) return;
  const localization::SlamCounts& counts = localizer_->counts();
  spdlog::info("{} stops, {} match tasks, {} loop closures", hashes_.size(), counts.tasks,
               sent_closures_.size());
  std::string message;
  if (localizer_.session() != nullptr) {
    message = pipeline::continuation_message(*localizer_.session());
    if (!message.empty()) spdlog::warn("{}", message);
  }
  service_.status().set_state(msg::kServiceFinished, message);
}

// Sends what has changed, or all of it, so that a reader has it whole in one version.
void LocalizerService::publish(bool whole) {
  const topomap::Trajectory trajectory = localizer_->trajectory();
  version_ = trajectory.version;
  if (const auto last = localizer_->last_stop()) last_stop_ = *last;
  std::vector<std::uint32_t> numbers = updates_.update(trajectory);
  if (whole) {
    numbers.resize(service::segment_count(trajectory.stops.size()));
    for (std::uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  }
  for (const std::uint32_t number : numbers) {
    const msg::TrajectorySegment segment =
        service::to_segment(trajectory, number, service_.robot_id(), segments_sent_++);
    if (!service_.send(segments_, segment, "trajectory")) throw Stopped();
  }
  publish_decisions();
  std::vector<topomap::LoopClosure> closures = localizer_->loop_closures();
  if (!whole && same(closures, sent_closures_)) return;
  sent_closures_ = std::move(closures);
  const msg::LoopClosures message = service::to_msg(sent_closures_, version_, service_.robot_id(),
                                                    last_stop_.stamp_ns, closures_sent_++);
  if (!service_.send(closures_, message, "loop closures")) throw Stopped();
}

// Decisions only come to the end, so only the last segment that was sent and those behind it have
// changed.
void LocalizerService::publish_decisions() {
  const std::vector<localization::LoopDecision>& decisions = localizer_->loop_decisions();
  if (decisions.size() == decisions_published_) return;
  const auto first = static_cast<std::uint32_t>(decisions_published_ / msg::kSegmentDecisions);
  for (std::uint32_t i = first; i < service::decision_segment_count(decisions.size()); ++i) {
    const msg::LoopDecisions segment = service::to_segment(
        decisions, i, service_.robot_id(), last_stop_.stamp_ns, decision_segments_sent_++);
    if (!service_.send(decisions_, segment, "loop decisions")) throw Stopped();
  }
  decisions_published_ = decisions.size();
}

// --- counters

void LocalizerService::count() {
  messaging::StatusPublisher& status = service_.status();
  const localization::SlamCounts& counts = localizer_->counts();
  const auto set = [&status](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  set("local_maps", hashes_.size());
  set("stops", hashes_.size());
  set("tasks", counts.tasks);
  set("evaluations", counts.evaluations);
  for (std::size_t i = 0; i < localization::kReasons; ++i) {
    const auto reason = static_cast<localization::Reason>(i);
    const std::string name = localization::to_string(reason);
    set(reason == localization::Reason::kNone ? name : "rejected: " + name, counts.reasons[i]);
  }
  set("loop_closures", sent_closures_.size());
  set("loop_decisions", localizer_->loop_decisions().size());
  set("optimizations", counts.optimizations);
  set("failed_optimizations", counts.failed_optimizations);
  set("unconfirmed_loops", counts.unconfirmed_loops);
  set("removed_loops", counts.removed_loops);
  set("steps_in_doubt", counts.steps_in_doubt);
  if (const localization::MappingSession* session = localizer_.session()) {
    if (options_.continued) {
      for (const auto& [name, value] : pipeline::continuation_counts(*session)) set(name, value);
    }
    set("stops_in_map", stops_in_map());
  }
  if (const auto* in_map = localizer_.map_localizer()) {
    for (const auto& [name, value] : pipeline::localization_counts(*in_map)) set(name, value);
  }
  count_pool();
}

void LocalizerService::count_pool() {
  messaging::StatusPublisher& status = service_.status();
  const search_pool::BoardCounts& counts = pool_.counts();
  const search_pool::RegistryCounts& refused = pool_.registry_counts();
  const auto set = [&status](const std::string& name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  const auto set_ms = [&status](const std::string& name, search_pool::BoardTime time) {
    status.set_counter(name, std::chrono::duration<double, std::milli>(time).count());
  };
  set("workers", pool_.workers());
  set("workers_lost", counts.workers_lost);
  set("workers_excluded", counts.workers_excluded);
  set("workers_of_other_version", refused.other_version);
  set("workers_of_other_matcher", refused.other_matcher);
  set("workers_of_other_configuration", refused.other_configuration);
  set("workers_of_one_id", refused.shared_ids);
  set("tasks_sent", counts.sent);
  set("tasks_resent", counts.resent);
  set("tasks_redone", counts.redone);
  set("tasks_in_process", counts.in_process);
  set("tasks_failed", counts.failed);
  set("maps_missing", counts.map_missing);
  set("maps_sent", pool_.maps_sent());
  set("answers_ignored", counts.ignored);
  set("audits", counts.audits);
  set("audit_differences", counts.audit_differences);
  set("duplicates", counts.duplicates);
  set("duplicate_differences", counts.duplicate_differences);
  set_ms("recovery_ms", counts.last_recovery);
  set_ms("longest_recovery_ms", counts.longest_recovery);
}

}  // namespace topogeo::localizer
