#include "map_store_service.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "topogeo/messaging/message.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/merge_conversions.hpp"
#include "topogeo/support/log.hpp"

#include "result_files.hpp"
#include "stored_input.hpp"

namespace topogeo::map_store {

using std::chrono::milliseconds;

namespace {

// The live map shares the cores with the localizer: 50 ms of work every 250 ms, a fifth; more when
// it is far behind, after a restart or a loop that moves everything.
constexpr milliseconds kLivePeriod{250};
constexpr milliseconds kLiveSlice{50};
constexpr milliseconds kCatchUpSlice{150};
constexpr std::size_t kFarBehind = 1000;  // local maps, a tenth of a second of work
constexpr int kLiveShare = 5;
constexpr std::chrono::seconds kPublishPeriod{2};
constexpr milliseconds kStorePeriod{200};
constexpr std::chrono::seconds kStoreRetryPeriod{1};
constexpr std::chrono::seconds kEdgePeriod{2};  // measurements: at most a twentieth of the time
constexpr int kEdgeShare = 20;
// Answers to map requests take a quarter of the time while there are any.
constexpr milliseconds kSnapshotPeriod{40};
constexpr milliseconds kSnapshotSlice{10};
constexpr std::uint32_t kPiecesUnderWay = 64;  // 3.6 MB
constexpr std::chrono::seconds kRetryPeriod{5};

}  // namespace

MapStoreService::MapStoreService(service::Service& service, MapStoreOptions options,
                                 storage::MapDatabase database)
    : service_(service),
      options_(std::move(options)),
      archive_(std::move(database), options_.database),
      input_(stored_input(archive_.database(), options_.drawing, shown_, stored_rooms_)),
      verdicts_(service, archive_.database(), [this](const auto& all) { return keep(all); }),
      live_map_(service.setup().config.config.global_map),
      elements_(service),
      hybrid_(service, stored_rooms_, std::exchange(shown_, std::nullopt)),
      ends_out_(service.advertise<msg::StreamEnd>()),
      acknowledged_(service),
      pieces_out_(service.advertise<msg::SnapshotPiece>()),
      snapshots_(
          service.robot_id(),
          [this](const auto& request, const auto& sink) { write_snapshot(request, sink); },
          [this](const msg::SnapshotPiece& piece) { return send_piece(piece); }),
      copies_(
          service, options_.database,
          [this] {
            if (!finished_ && !store(true))
              throw std::runtime_error("the map cannot be stored now");
          },
          [this](const std::string& name) {
            wanted_snapshot_ = name;
            acknowledged_.withdraw();
            service_.loop().stop();
          }),
      drawing_(service, options_.drawing, true,
               service.setup().config.config.hybrid_map.grid.resolution_m,
               [this](storage::MapDrawing drawing) { take_drawing(std::move(drawing)); }) {
  stored_refusals_ = input_.refused_merges().size();
  if (!options_.drawing.empty()) archive_.put(options_.drawing);
  // Even an empty map is published before the first scan; one that must be fused first follows
  // later.
  if (hybrid_.map() || input_.local_maps().empty()) {
    publish(hybrid_.map().value_or(topomap::GlobalMap{}));
  }
  if (options_.drawing.grid) hybrid_.redraw();
  drawing_.publish(last_stamp_ns());
  listen<msg::LocalMap>([this](const msg::LocalMap& map) { on_local_map(map); },
                        {.team = true, .main_input = true});
  listen<msg::TrajectorySegment>(
      [this](const msg::TrajectorySegment& segment) { input_.add(segment); });
  listen<msg::LoopClosures>([this](const msg::LoopClosures& closures) { input_.add(closures); });
  listen<msg::MapEdges>([this](const msg::MapEdges& edges) { input_.add(edges); });
  listen<msg::MergeProposal>([this](const msg::MergeProposal& proposal) {
    if (proposal.state() != msg::kMergeRefused) return;
    const localization::MergeProposal refused = service::from_msg(proposal);
    input_.add(storage::RefusedMerge{refused.place.stop, refused.place.other});
  });
  listen<msg::StreamEnd>([this](const msg::StreamEnd& end) {
    if (end.stage() == msg::kStageLocalizer) input_.set_end(end);
  });
  service_.subscribe<msg::SnapshotRequest>(
      [this](const msg::SnapshotRequest& request) { snapshots_.add(request); }, {.team = true});
  service_.loop().add_timer(kStorePeriod, [this] {
    if (!finished_) store();
    verdicts_.store(false);
    finish_if_complete();
    report_losses();
    count();
  });
  service_.loop().add_timer(kSnapshotPeriod,
                            [this] { snapshots_.work(Clock::now(), kSnapshotSlice); });
  service_.loop().add_timer(kLivePeriod, [this] {
    if (finished_) {
      publish_hybrid();
    } else {
      work_on_live_map();
    }
  });
  acknowledged_.publish(archive_.database());
  count();
  service_.status().wait_for("local maps");
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
  topomap::LocalMap map = service::from_msg(message);
  acknowledged_.name_session(map.stop.session, map.robot_id);
  archive_.add(map);
  if (input_.add(std::move(map)) == MapInput::Arrival::kDifferent) {
    service_.status().fault("local map differs",
                            "another map " + std::to_string(message.id()) + " came before");
  }
  if (archive_.has_batch()) store();
}

bool MapStoreService::store(bool all) {
  if (Clock::now() < next_store_) return false;
  messaging::StatusPublisher& status = service_.status();
  try {
    for (const topomap::StopId& stop : archive_.flush()) {
      status.fault("local map differs",
                   "another map " + std::to_string(stop.number) + " is in the map file");
    }
    acknowledged_.publish(archive_.database());
    archive_.put(input_.local_maps(), input_.newest_trajectory(), input_.usable_closures());
    store_edges(all);
    if (input_.refused_merges().size() != stored_refusals_) {
      archive_.put(input_.refused_merges());
      stored_refusals_ = input_.refused_merges().size();
    }
    acknowledged_.publish(archive_.database());
    if (storing_fails_) {
      spdlog::info("storing the map works again");
      status.set_state(msg::kServiceRunning);
    }
    storing_fails_ = false;
    return true;
  } catch (const std::exception& error) {
    storing_failed(error.what());
    return false;
  }
}

// Limited, because all edges are compared with the stored ones, which takes long on a large map.
void MapStoreService::store_edges(bool now) {
  if (input_.edge_changes() == stored_edges_ || (!now && Clock::now() < next_edges_)) return;
  const auto start = Clock::now();
  archive_.put(input_.usable_edges());
  stored_edges_ = input_.edge_changes();
  const auto end = Clock::now();
  next_edges_ = end + std::max<Clock::duration>(kEdgePeriod, kEdgeShare * (end - start));
}

// The map continues in memory; senders keep unacknowledged data.
void MapStoreService::storing_failed(const std::string& why) {
  service_.status().fault("database", why);
  service_.status().set_state(msg::kServiceFailed, why);
  storing_fails_ = true;
  next_store_ = Clock::now() + kStoreRetryPeriod;
}

template <class Part>
bool MapStoreService::keep(const Part& part) {
  if (storing_fails_) return false;  // store() reports it
  try {
    archive_.put(part);
    return true;
  } catch (const std::exception& error) {
    storing_failed(error.what());
    return false;
  }
}

void MapStoreService::write_snapshot(const msg::SnapshotRequest& request,
                                     const SnapshotQueue::Sink& sink) {
  if (request.kind() == msg::kSnapshotMap && request.session() != 0) {
    storage::MapDatabase::open_read_only(copies_.path_of(request.session())).write_map_file(sink);
    return;
  }
  if (!finished_) store(true);  // the snapshot lacks data that cannot be stored
  const storage::MapDatabase& database = archive_.database();
  if (request.kind() == msg::kSnapshotMap) {
    database.write_map_file(sink);
  } else {
    database.write_local_maps(request.session(), request.first(), sink);
  }
}

bool MapStoreService::send_piece(const msg::SnapshotPiece& piece) {
  // Limits the pieces under way: those that a slow reader does not take stay in memory.
  if (piece.piece() % kPiecesUnderWay == 0 &&
      !pieces_out_.wait_for_acknowledgments(kSnapshotSlice)) {
    return false;
  }
  return pieces_out_.write(piece);
}

void MapStoreService::work_on_live_map() {
  const topomap::Trajectory trajectory = input_.newest_trajectory();
  live_map_.renumber(trajectory.numbered_since);
  // Not between a map and its publication: frequent corrections would leave nothing to publish.
  if (Clock::now() >= next_publish_) live_map_.check(trajectory.stops);
  const auto start = Clock::now();
  const bool far_behind = live_map_.size() + kFarBehind < input_.local_maps().size();
  const milliseconds slice = far_behind ? kCatchUpSlice : kLiveSlice;
  bool more = true;
  while (more && Clock::now() - start < slice) {
    try {
      more = live_map_.step(input_.local_maps(), trajectory.stops);
    } catch (const std::invalid_argument& error) {
      service_.status().fault("local map not fused", error.what());
    }
  }
  publish_hybrid();
  const bool changed = live_map_.size() != published_maps_ ||
                       live_map_.rebuilds() != published_rebuilds_ ||
                       trajectory.version != published_version_;
  if (more || !changed || Clock::now() < next_publish_) return;
  const auto publish_start = Clock::now();
  hybrid_.take(live_map_.snapshot(trajectory.version));
  const bool sent = publish(*hybrid_.map());
  keep(*hybrid_.map());
  if (sent) {
    published_maps_ = live_map_.size();
    published_rebuilds_ = live_map_.rebuilds();
    published_version_ = trajectory.version;
  }
  const auto now = Clock::now();
  next_publish_ =
      now + std::max<Clock::duration>(kPublishPeriod, kLiveShare * (now - publish_start));
}

bool MapStoreService::publish(const topomap::GlobalMap& map) {
  return elements_.publish(map, archive_.database().map_id(), last_stamp_ns());
}

std::int64_t MapStoreService::last_stamp_ns() const {
  const std::vector<topomap::LocalMap>& maps = input_.local_maps();
  return maps.empty() ? 0 : maps.back().stamp_ns;
}

void MapStoreService::take_drawing(storage::MapDrawing drawing) {
  archive_.put(drawing);
  options_.drawing = std::move(drawing);
  drawn_since_ = finished_;
  hybrid_.redraw();
}

void MapStoreService::publish_hybrid() {
  if (!hybrid_.due()) return;
  const topomap::Trajectory trajectory = input_.newest_trajectory();
  pipeline::HybridMapParts parts;
  parts.local_maps = input_.local_maps();
  parts.stops = trajectory.stops;
  parts.drawing = &options_.drawing;
  hybrid_.make(parts, last_stamp_ns());
  if (hybrid_.rooms() != stored_rooms_ && keep(hybrid_.rooms())) stored_rooms_ = hybrid_.rooms();
}

void MapStoreService::finish_if_complete() {
  if (finished_ || Clock::now() < next_attempt_) return;
  const std::optional<topomap::Trajectory> trajectory = input_.final_trajectory();
  if (!trajectory) return;
  try {
    finish(*trajectory);
  } catch (const std::exception& error) {
    // The disk may be cleared, and the map is still here: try again later.
    service_.status().fault("results not written", error.what());
    service_.status().set_state(msg::kServiceFailed, error.what());
    next_attempt_ = Clock::now() + kRetryPeriod;
  }
}

storage::MapDocument MapStoreService::final_document(const topomap::Trajectory& trajectory,
                                                     const planning::RoomMemory& rooms) const {
  const auto& before = options_.continued;
  if (before && before->trajectory.stops.size() == trajectory.stops.size() &&
      before->trajectory.numbered_since == trajectory.numbered_since) {
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
  document.edges = input_.usable_edges();
  document.global_map = pipeline::fuse(config.global_map, document.local_maps, trajectory);
  document.drawing = options_.drawing;
  document.map_id = archive_.database().map_id();
  document.refused_merges = input_.refused_merges();
  document.rooms = rooms;
  pipeline::remember_rooms(document, config.hybrid_map);
  return document;
}

void MapStoreService::end() {
  verdicts_.store(true);
  if ((finished_ && !drawn_since_) || input_.newest_trajectory().stops.empty()) return;
  next_store_ = {};
  live_map_ = LiveMap(service_.setup().config.config.global_map);  // frees its memory
  store(true);
  const storage::MapDocument document = final_document(input_.newest_trajectory(), hybrid_.rooms());
  write_results(options_.directory, document, options_.title);
  spdlog::info("stopped: the map so far has {} local maps, {} nodes and {} branches, in {}",
               document.local_maps.size(), document.global_map.nodes.size(),
               document.global_map.branches.size(), options_.directory.string());
  keep(document.global_map);
  keep(document.rooms);
}

void MapStoreService::finish(const topomap::Trajectory& trajectory) {
  if (!store(true)) throw std::runtime_error("cannot update the map file");
  // Same as a run in one process: room numbers of intermediate maps depend on their timing.
  const auto& before = options_.continued;
  const storage::MapDocument document =
      final_document(trajectory, before ? before->rooms : planning::RoomMemory{});
  if (!publish(document.global_map)) throw std::runtime_error("cannot send the map");
  archive_.put(document.global_map);
  archive_.put(document.rooms);
  hybrid_.remember(document.rooms);
  write_results(options_.directory, document, options_.title);

  hybrid_.finish(pipeline::parts_of(document), trajectory.stops.back().stamp_ns);

  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), trajectory.stops.back().stamp_ns, 0);
  end.stage(msg::kStageMapStore);
  end.count(document.global_map.nodes.size() + document.global_map.branches.size());
  end.last_id(hybrid_.version());
  end.version(trajectory.version);
  if (!service_.send(ends_out_, end, "stream end")) return;
  finished_ = true;
  count();
  spdlog::info("{} local maps, {} nodes and {} branches in {}", document.local_maps.size(),
               document.global_map.nodes.size(), document.global_map.branches.size(),
               options_.directory.string());
  service_.status().set_state(msg::kServiceFinished);
}

void MapStoreService::report_losses() {
  const std::optional<topomap::StopId> lost = input_.lost();
  if (!lost || service_.status().state() == msg::kServiceFailed) return;
  const std::string what = "local map " + std::to_string(lost->number) +
                           " was dropped before the trajectory contained it: the map ends there";
  service_.status().fault("local map lost", what);
  service_.status().set_state(msg::kServiceFailed, what);
}

void MapStoreService::count() {
  messaging::StatusPublisher& status = service_.status();
  const auto set = [&status](const char* name, std::uint64_t value) {
    status.set_counter(name, static_cast<double>(value));
  };
  set("local_maps", input_.local_maps().size());
  set("trajectory_version", input_.version());
  set("loop_closures", input_.usable_closures().size());
  set("stored_local_maps", archive_.database().local_map_count());
  set("snapshots_served", snapshots_.served());
  set("snapshots_refused", snapshots_.refused());
  set("map_rebuilds", live_map_.rebuilds());
  status.set_queue("local maps without pose", input_.waiting(), MapInput::kMostWaiting);
  status.set_queue("local maps to store", archive_.queued(), MapArchive::kMostQueued);
  status.set_queue("snapshot requests", snapshots_.waiting(), SnapshotQueue::kMostRequests);
  status.set_drops("local map in no map", input_.dropped());
}

}  // namespace topogeo::map_store
