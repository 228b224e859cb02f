#include "map_archive.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <sys/stat.h>

#include "topogeo/support/hash.hpp"
#include "topogeo/support/log.hpp"

namespace topogeo::map_store {

namespace {

// Longest time that the service's loop stands still while another program holds the file.
constexpr std::chrono::milliseconds kPatience{250};

/// Inode number of a file; 0 when there is none.
std::uint64_t file_number(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

void add(support::Fnv1a& hash, double value) {
  hash.add(std::bit_cast<std::uint64_t>(value));
}

void add(support::Fnv1a& hash, const geometry::Pose2& pose) {
  for (const double value : {pose.x_m, pose.y_m, pose.theta_rad}) add(hash, value);
}

std::uint64_t hash_of(std::span<const topomap::LoopClosure> closures) {
  support::Fnv1a hash;
  for (const topomap::LoopClosure& closure : closures) {
    hash.add(std::uint64_t{closure.earlier_id});
    hash.add(std::uint64_t{closure.later_id});
    add(hash, closure.T_earlier_later);
  }
  return hash.value();
}

std::uint64_t hash_of(std::span<const topomap::StopPose> stops) {
  support::Fnv1a hash;
  for (const topomap::StopPose& stop : stops) {
    hash.add(stop.stop.session);
    hash.add(std::uint64_t{stop.stop.number});
    add(hash, stop.T_map_robot);
    for (const double value : stop.covariance.reshaped()) add(hash, value);
    hash.add(std::uint64_t{stop.located});
    hash.add(std::uint64_t{stop.views});
    hash.add(static_cast<std::uint64_t>(stop.last_view_ns));
  }
  return hash.value();
}

}  // namespace

MapArchive::MapArchive(storage::MapDatabase database, std::filesystem::path path)
    : database_(std::move(database)), path_(std::move(path)), file_(file_number(path_)) {
  database_.set_patience(kPatience);
}

void MapArchive::add(const topomap::LocalMap& map) {
  if (queue_.size() >= kMostQueued || database_.knows(map.stop)) return;
  if (queued_.insert(map.stop).second) queue_.push_back(map);
}

std::vector<topomap::StopId> MapArchive::flush() {
  std::vector<topomap::StopId> different;
  if (queue_.empty()) return different;
  check_file();
  while (!queue_.empty()) {
    const std::size_t count = std::min(kBatch, queue_.size());
    const auto refused = database_.put_stops(std::span(queue_).first(count));
    different.insert(different.end(), refused.begin(), refused.end());
    for (std::size_t i = 0; i < count; ++i) queued_.erase(queue_[i].stop);
    queue_.erase(queue_.begin(), queue_.begin() + static_cast<std::ptrdiff_t>(count));
  }
  // Not at every stop that arrives.
  if (database_.waiting_count() >= kMostWaiting + kBatch) database_.drop_waiting(kMostWaiting);
  return different;
}

void MapArchive::put(std::span<const topomap::LocalMap> local_maps,
                     const topomap::Trajectory& trajectory,
                     std::span<const topomap::LoopClosure> closures) {
  std::vector<storage::JoinedStop> joined;
  if (trajectory.numbered_since != database_.numbered_since()) {
    for (const topomap::LocalMap& map : local_maps) joined.push_back({map.stop, map.starts_drive});
    check_file();
    database_.renew(trajectory, closures, joined);
    remember(trajectory, closures);
    return;
  }
  for (std::size_t i = database_.local_map_count(); i < local_maps.size(); ++i) {
    joined.push_back({local_maps[i].stop, local_maps[i].starts_drive});
  }
  const bool same = trajectory.version == version_ && hash_of(trajectory.stops) == poses_ &&
                    hash_of(closures) == closures_;
  if (joined.empty() && same) return;
  check_file();
  database_.put_trajectory(trajectory.version, trajectory.stops, closures, joined);
  remember(trajectory, closures);
}

void MapArchive::remember(const topomap::Trajectory& trajectory,
                          std::span<const topomap::LoopClosure> closures) {
  version_ = trajectory.version;
  poses_ = hash_of(trajectory.stops);
  closures_ = hash_of(closures);
}

void MapArchive::put(const std::vector<storage::MapEdge>& edges) {
  check_file();
  database_.put_edges(edges);
}

void MapArchive::put(const std::vector<storage::LoopVerdict>& verdicts) {
  check_file();
  database_.put_loop_verdicts(verdicts);
}

void MapArchive::put(const topomap::GlobalMap& map) {
  check_file();
  database_.put_global_map(map);
}

void MapArchive::put(const storage::MapDrawing& drawing) {
  check_file();
  database_.put_drawing(drawing);
}

void MapArchive::put(const std::vector<storage::RefusedMerge>& refused) {
  check_file();
  database_.put_refused_merges(refused);
}

void MapArchive::put(const planning::RoomMemory& rooms) {
  check_file();
  database_.put_rooms(rooms);
}

void MapArchive::check_file() {
  const std::uint64_t there = file_number(path_);
  if (there == file_) return;
  if (there != 0) {
    throw std::runtime_error(
        path_.string() +
        ": another file has replaced the open database; move that file away, or stop "
        "the map store before you put a file there");
  }
  spdlog::warn("{} was removed: writing it again", path_.string());
  std::filesystem::path again = path_;
  again += ".again";
  for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(again.string() + part);
  database_.copy_to(again);
  for (const char* part : {"-wal", "-shm"}) std::filesystem::remove(path_.string() + part);
  std::filesystem::rename(again, path_);
  database_ = storage::MapDatabase::open_existing(path_);
  database_.set_patience(kPatience);
  file_ = file_number(path_);
}

}  // namespace topogeo::map_store
