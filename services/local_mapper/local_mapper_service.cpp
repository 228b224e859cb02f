#include "local_mapper_service.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "topogeo/messaging/message.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/log.hpp"
#include "topogeo/support/random.hpp"

namespace topogeo::local_mapper {
namespace {

/// When a log has ended, all its scans have been delivered; a busy mapper has them in its queue.
constexpr std::chrono::seconds kLastScans{1};

}  // namespace

LocalMapperService::LocalMapperService(service::Service& service, bool replay, bool standalone)
    : service_(service),
      // Random salt separates two sessions that start with the same view of a standing laser.
      mapper_(service.setup().config.config.local_mapper, service.robot_id(),
              replay ? 0 : support::unrepeatable_u64()),
      local_maps_(service.advertise<msg::LocalMap>()),
      tracked_poses_(service.advertise<msg::TrackedPose>()),
      ends_out_(service.advertise<msg::StreamEnd>()),
      replay_(replay) {
  for (const char* counter :
       {"scans", "local_maps", "local_maps_kept", "tracked_scans", "matched_scans"}) {
    service_.status().set_counter(counter, 0.0);
  }
  if (standalone) {
    begin();
    return;
  }
  service_.status().wait_for("the map store");
  store_.emplace(service, [this](const msg::StoredMap& stored) { on_stored(stored); });
}

void LocalMapperService::on_stored(const msg::StoredMap& stored) {
  if (stored.session() == msg::kNothingIsStored) {
    sent_.set_nothing_stored();
  } else {
    sent_.set_stored(stored.session(), stored.session_stops());
  }
  release();
  if (begun_ || stored_) return;
  // A log added to its own map is another session (as in MappingRun).
  if (replay_ && stored.stops() > 0) mapper_.set_session_salt(stored.map_id());
  if (stored.session_stops() == 0) {
    begin();
    return;
  }
  stored_ = stored;
  store_->request(msg::kSnapshotLocalMaps, stored.session(), stored.session_stops() - 1,
                  [this](const service::StoreClient::Answer& answer) { on_last_stop(answer); });
}

void LocalMapperService::on_last_stop(const service::StoreClient::Answer& answer) {
  try {
    if (!answer.bytes) throw std::invalid_argument(answer.why);
    const std::vector<topomap::LocalMap> stops =
        storage::parse_local_maps(*answer.bytes, "snapshot");
    if (stops.empty()) throw std::invalid_argument("the snapshot has no stops");
    mapper_.resume(stops.back());
    resumed_ = {stops.back().odometry_epoch, stops.back().sequence};
    spdlog::info("resuming after stop {}", stops.back().stop.number);
  } catch (const std::exception& error) {
    service_.status().fault("no snapshot", error.what());
    spdlog::warn("cannot resume the session, beginning a new one: {}", error.what());
  }
  begin();
}

void LocalMapperService::begin() {
  begun_ = true;
  if (replay_) missing_.emplace(service_);
  service_.subscribe<msg::Scan>(
      [this](const msg::Scan& scan) { on_scan(scan); },
      {.role = replay_ ? std::string(messaging::kReplayRole) : std::string(), .main_input = true});
  service_.subscribe<msg::StreamEnd>([this](const msg::StreamEnd& end) { on_stream_end(end); });
  service_.status().wait_for("scans");
}

// The map store provides stored maps when they are needed again.
void LocalMapperService::release() {
  const bool readers_have_all =
      sent_.depends_on_readers() && local_maps_.wait_for_acknowledgments({});
  for (const topomap::StopId& stop : sent_.take_old(readers_have_all)) {
    msg::LocalMap gone;
    gone.session(stop.session);
    gone.id(stop.number);
    local_maps_.dispose(gone);
  }
  service_.status().set_counter("local_maps_kept", static_cast<double>(sent_.size()));
}

void LocalMapperService::on_scan(const msg::Scan& message) {
  if (finished_) {
    service_.status().fault("scan after the end", std::to_string(message.sequence_number()));
    return;
  }
  if (const std::optional<scan::Scan> scan = accept(message)) {
    if (service_.status().state() != msg::kServiceRunning) {
      service_.status().set_state(msg::kServiceRunning);
    }
    service_.status().set_counter("scans", static_cast<double>(++scans_used_));
    std::optional<topomap::LocalMap> map;
    try {
      map = mapper_.add(*scan);
    } catch (const std::invalid_argument& error) {
      service_.status().fault("unusable scan", error.what());
    }
    if (map) publish(*map);
    publish_tracked();
  }
  finish_if_complete();
}

std::optional<scan::Scan> LocalMapperService::accept(const msg::Scan& message) {
  messaging::StatusPublisher& status = service_.status();
  const std::uint64_t sequence = message.sequence_number();
  const std::string name = "scan " + std::to_string(sequence);
  // Validate the whole message first. Otherwise source and number of a rejected message would
  // count, and a stranger could have a log read again for ever (faults_strangers).
  scan::Scan scan;
  try {
    scan = service::from_msg(message);
  } catch (const std::invalid_argument& error) {
    status.fault("invalid scan", name + ": " + error.what());
    return std::nullopt;
  }
  // A log that is read again repeats the scans up to the last stop.
  if (replay_ && !odometry_epoch_ && resumed_ && resumed_->first == message.odometry_epoch()) {
    next_sequence_ = resumed_->second + 1;
    scans_used_ = next_sequence_;
    maps_ = std::uint64_t{mapper_.last_stop().number} + 1;
  }
  // A gateway with devices may already be running; a log begins with its first scan.
  const bool joins = !odometry_epoch_ && !replay_;
  const bool other_source = odometry_epoch_ && odometry_epoch_ != message.odometry_epoch();
  odometry_epoch_ = message.odometry_epoch();
  if (joins || other_source) {  // or the source has restarted
    next_sequence_ = sequence;
    geometry_.reset();
    last_stamp_ns_ = std::numeric_limits<std::int64_t>::min();
  }
  if (sequence < next_sequence_) {
    status.fault("old scan", name + ", expected " + std::to_string(next_sequence_));
    return std::nullopt;
  }
  if (sequence > next_sequence_) {
    if (missing_ && missing_->want(message.odometry_epoch(), next_sequence_)) return std::nullopt;
    status.fault("scans missing", name + ", expected " + std::to_string(next_sequence_));
  }
  next_sequence_ = sequence + 1;
  if (missing_) missing_->found();
  const Geometry geometry{scan.angle_min_rad, scan.angle_step_rad, scan.ranges_m.size()};
  if (geometry_ && geometry != *geometry_) {
    status.fault("changed scan geometry",
                 name + " has " + std::to_string(geometry.beams) + " beams from " +
                     std::to_string(geometry.angle_min_rad) + " rad, the first had " +
                     std::to_string(geometry_->beams) + " from " +
                     std::to_string(geometry_->angle_min_rad) + " rad");
    return std::nullopt;
  }
  if (scan.stamp_ns <= last_stamp_ns_) {
    status.fault("time not increasing", name);
    return std::nullopt;
  }
  geometry_ = geometry;
  last_stamp_ns_ = scan.stamp_ns;
  return scan;
}

void LocalMapperService::publish(const topomap::LocalMap& map) {
  tracked_ += map.track.size();
  matched_ += static_cast<std::uint64_t>(
      std::count_if(map.track.begin(), map.track.end(),
                    [](const topomap::TrackedScan& scan) { return scan.matched; }));
  release();  // by now readers have had the time to take the one before
  try {
    if (!service_.send(local_maps_, service::to_msg(map), "local map")) return;
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(error.what());  // no scan's fault; the run needs the map
  }
  sent_.add(map.stop);
  service_.status().set_counter("local_maps", static_cast<double>(++maps_));
  service_.status().set_counter("tracked_scans", static_cast<double>(tracked_));
  service_.status().set_counter("matched_scans", static_cast<double>(matched_));
}

// A scan that cannot be sent now would be outdated later.
void LocalMapperService::publish_tracked() {
  const topomap::TrackedScan* scan = mapper_.last_tracked();
  if (scan == nullptr) return;
  if (!tracked_poses_.write(service::to_msg(*scan, mapper_.last_stop(), service_.robot_id()))) {
    service_.status().add_drops("tracked pose not sent");
  }
}

void LocalMapperService::on_stream_end(const msg::StreamEnd& message) {
  if (message.stage() != msg::kStageGateway) return;
  scans_in_stream_ = message.count();
  finish_if_complete();
  if (missing_ && !finished_) look_for_rest(next_sequence_);
}

void LocalMapperService::look_for_rest(std::uint64_t next_before) {
  service_.loop().cancel_timer(rest_timer_);
  rest_timer_ = service_.loop().call_after(kLastScans, [this, next_before] {
    if (!finished_ && (next_sequence_ != next_before || want_rest())) {
      look_for_rest(next_sequence_);
    }
  });
}

bool LocalMapperService::want_rest() {
  const bool continues = !odometry_epoch_ && resumed_;
  const std::uint64_t epoch = continues ? resumed_->first : odometry_epoch_.value_or(0);
  const std::uint64_t first = continues ? resumed_->second + 1 : next_sequence_;
  if (missing_->want(epoch, first)) return true;
  service_.status().fault(
      "scans missing", "the last scans of the log, from number " + std::to_string(first) + " on");
  next_sequence_ = *scans_in_stream_;
  finish_if_complete();
  return false;
}

void LocalMapperService::finish_if_complete() {
  if (finished_ || !scans_in_stream_ || next_sequence_ < *scans_in_stream_) return;
  finished_ = true;
  if (missing_) missing_->found();
  if (const std::optional<topomap::LocalMap> map = mapper_.finish()) publish(*map);
  msg::StreamEnd end;
  messaging::set_header(end, service_.robot_id(), last_stamp_ns_, 0);
  end.stage(msg::kStageLocalMapper);
  // When a log is read again, all its scans may have been mapped before.
  const std::uint64_t stops = scans_used_ == 0 && !resumed_ ? 0 : mapper_.last_stop().number + 1;
  end.count(stops);
  end.last_id(stops == 0 ? 0 : stops - 1);
  if (!service_.send(ends_out_, end, "stream end")) return;
  spdlog::info("{} local maps from {} scans", maps_, scans_used_);
  service_.status().set_state(msg::kServiceFinished);
}

}  // namespace topogeo::local_mapper
