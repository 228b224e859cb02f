#include "map_store_service.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/support/log.hpp"

#include "result_files.hpp"

namespace topogeo::map_store {

using std::chrono::milliseconds;

namespace {

// The live map shares the cores with the localizer: 50 ms of work every 250 ms, a fifth.
constexpr milliseconds kLivePeriod{250};
constexpr milliseconds kLiveSlice{50};
constexpr int kLiveShare = 5;
constexpr std::chrono::seconds kPublishPeriod{2};
// The hybrid map is made in one go and may take much longer: at most a tenth.
constexpr std::chrono::seconds kHybridPeriod{4};
constexpr int kHybridShare = 10;
constexpr milliseconds kStorePeriod{500};
constexpr std::chrono::seconds kRetryPeriod{5};

}  // namespace

MapStoreService::MapStoreService(service::Service& service, MapStoreOptions options,
                                 storage::MapDatabase database)
    : service_(service),
      options_(std::move(options)),
      database_(std::move(database)),
      input_(options_.continued ? options_.continued->local_maps
                                : std::vector<topomap::LocalMap>{}),
      live_map_(service.setup().config.config.global_map),
      elements_(service),
      hybrid_(service),
      ends_out_(service.advertise<msg::StreamEnd>()) {
  if (!options_.drawing.empty()) database_.put_drawing(options_.drawing);
  if (options_.drawing.grid) hybrid_pending_.emplace();  // there is a map before any scan
  listen<msg::LocalMap>([this](const msg::LocalMap& map) { on_local_map(map); },
                        {.main_input = true});
  listen<msg::TrajectorySegment>(
      [this](const msg::TrajectorySegment& segment) { input_.add(segment); });
  listen<msg::LoopClosures>([this](const msg::LoopClosures& closures) { input_.add(closures); });
  listen<msg::StreamEnd>([this](const msg::StreamEnd& end) {
    if (end.stage() == msg::kStageLocalizer) input_.set_end(end);
  });
  service_.loop().add_timer(kStorePeriod, [this] {
    if (!finished_) store();
    finish_if_complete();
    report_losses();
    count();
  });
  service_.loop().add_timer(kLivePeriod, [this] {
    if (finished_) {
      hybrid_.send_rest();
    } else {
      work_on_live_map();
    }
  });
  count();
  service_.status().set_state(msg::kServiceWaiting, "for local maps");
}

template <class T, class Handler>
void MapStoreService::listen(Handler handler, const service::Subscription& subscription) {
  service_.subscribe<T>(
      [this, handler](const T& message) {
        if (finished_) return;
        handler(message);
        finish_if_complete();
      },
      subscription);
}

void MapStoreService::on_local_map(const msg::LocalMap& message) {
  if (service_.status().state() == msg::kServiceWaiting) {
    service_.status().set_state(msg::kServiceRunning);
  }
  if (input_.add(service::from_msg(message)) == MapInput::Arrival::kDifferent) {
    service_.status().fault("local map differs",
                            "another map " + std::to_string(message.id()) + " came before");
  }
}

bool MapStoreService::store() {
  try {
    for (std::size_t i = database_.local_map_count(); i < input_.local_maps().size(); ++i) {
      const storage::SessionStop stop{1, 0, input_.local_maps()[i]};
      static_cast<void>(database_.put_stops({&stop, 1}));
      const storage::JoinedStop joined{stop.source(), false};
      database_.join({&joined, 1});
    }
    const topomap::Trajectory trajectory = input_.newest_trajectory();
    if (trajectory.version != stored_version_ || trajectory.stops.size() != stored_stops_) {
      database_.put_trajectory(trajectory.version, trajectory.stops, input_.usable_closures());
      stored_version_ = trajectory.version;
      stored_stops_ = trajectory.stops.size();
    }
    return true;
  } catch (const std::exception& error) {
    service_.status().fault("database", error.what());
    return false;
  }
}

void MapStoreService::work_on_live_map() {
  const topomap::Trajectory trajectory = input_.newest_trajectory();
  // Not between a map and its publication, or frequent corrections would leave nothing to publish.
  if (Clock::now() >= next_publish_) live_map_.check(trajectory.stops);
  const auto start = Clock::now();
  bool more = true;
  while (more && Clock::now() - start < kLiveSlice) {
    try {
      more = live_map_.step(input_.local_maps(), trajectory.stops);
    } catch (const std::invalid_argument& error) {
      service_.status().fault("local map not fused", error.what());
    }
  }
  publish_hybrid();
  const bool changed =
      live_map_.size() != published_maps_ || trajectory.version != published_version_;
  if (more || !changed || Clock::now() < next_publish_) return;
  const auto publish_start = Clock::now();
  hybrid_pending_ = live_map_.snapshot(trajectory.version);
  publish(*hybrid_pending_);
  published_maps_ = live_map_.size();
  published_version_ = trajectory.version;
  const auto now = Clock::now();
  next_publish_ =
      now + std::max<Clock::duration>(kPublishPeriod, kLiveShare * (now - publish_start));
}

void MapStoreService::publish(const topomap::GlobalMap& map) {
  if (input_.local_maps().empty()) return;
  elements_.publish(map, input_.local_maps().back().stamp_ns);
}

void MapStoreService::publish_hybrid() {
  hybrid_.send_rest();
  if (!hybrid_pending_ || Clock::now() < next_hybrid_) return;
  const auto start = Clock::now();
  const topomap::Trajectory trajectory = input_.newest_trajectory();
  pipeline::HybridMapParts parts;
  parts.local_maps = input_.local_maps();
  parts.stops = trajectory.stops;
  parts.global_map = &*hybrid_pending_;
  parts.drawing = &options_.drawing;
  hybrid_.publish(parts, parts.local_maps.empty() ? 0 : parts.local_maps.back().stamp_ns);
  hybrid_pending_.reset();
  const auto now = Clock::now();
  next_hybrid_ = now + std::max<Clock::duration>(kHybridPeriod, kHybridShare * (now - start));
}

void MapStoreService::finish_if_complete() {
  if (finished_ || Clock::now() < next_attempt_) return;
  const std::optional<topomap::Trajectory> trajectory = input_.final_trajectory();
  if (!trajectory) return;
  try {
    finish(*trajectory);
  } catch (const std::exception& error) {
    // A full disk may be cleared: the map is still here, so this is tried again.
    service_.status().fault("results not written", error.what());
    service_.status().set_state(msg::kServiceFailed, error.what());
    next_attempt_ = Clock::now() + kRetryPeriod;
  }
}

storage::MapDocument MapStoreService::final_document(const topomap::Trajectory& trajectory) const {
  const auto& before = options_.continued;
  if (before && before->trajectory.stops.size() == trajectory.stops.size()) {
    storage::MapDocument same = *before;
    same.drawing = options_.drawing;
    return same;
  }
  const pipeline::Config& config = service_.setup().config.config;
  storage::MapDocument document;
  document.robot_id = service_.robot_id();
  document.seed = config.localizer.seed;
  document.local_maps = input_.local_maps();
  document.trajectory = trajectory;
  document.loop_closures = input_.usable_closures();
  document.global_map = pipeline::fuse(config.global_map, document.local_maps, trajectory);
  document.drawing = options_.drawing;
  return document;
}

void MapStoreService::finish(const topomap::Trajectory& trajectory) {
  const storage::MapDocument document = final_document(trajectory);
  publish(document.global_map);
  stored_version_ = 0;  // the closures of this version may have come after its poses were stored
  if (!store()) throw std::runtime_error("the database could not be brought up to date");
  database_.put_global_map(document.global_map);
  write_results(options_.directory, document, options_.title);

  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), trajectory.stops.back().stamp_ns, 0);
  end.stage(msg::kStageMapStore);
  end.count(document.global_map.nodes.size() + document.global_map.branches.size());
  end.version(trajectory.version);
  if (!service_.send(ends_out_, end, "stream end")) return;
  finished_ = true;
  hybrid_.publish(pipeline::parts_of(document), trajectory.stops.back().stamp_ns);
  count();
  spdlog::info("{} local maps, {} nodes and {} branches in {}", document.local_maps.size(),
               document.global_map.nodes.size(), document.global_map.branches.size(),
               options_.directory.string());
  service_.status().set_state(msg::kServiceFinished);
}

void MapStoreService::report_losses() {
  if (input_.dropped() > 0 && !reported_drops_) {
    reported_drops_ = true;
    spdlog::warn("local maps that have joined no map are dropped, see local_maps_dropped");
  }
  const std::optional<topomap::StopId> lost = input_.lost();
  if (!lost || service_.status().state() == msg::kServiceFailed) return;
  const std::string what = "local map " + std::to_string(lost->number) +
                           " had to be dropped before the trajectory named it: the map ends there";
  service_.status().fault("local map lost", what);
  service_.status().set_state(msg::kServiceFailed, what);
}

void MapStoreService::count() {
  messaging::StatusPublisher& status = service_.status();
  status.set_counter("local_maps", static_cast<double>(input_.local_maps().size()));
  status.set_counter("local_maps_waiting", static_cast<double>(input_.waiting()));
  status.set_counter("local_maps_dropped", static_cast<double>(input_.dropped()));
  status.set_counter("trajectory_version", static_cast<double>(input_.version()));
  status.set_counter("loop_closures", static_cast<double>(input_.usable_closures().size()));
  status.set_counter("stored_local_maps", static_cast<double>(database_.local_map_count()));
  status.set_counter("map_rebuilds", static_cast<double>(live_map_.rebuilds()));
}

}  // namespace topogeo::map_store
