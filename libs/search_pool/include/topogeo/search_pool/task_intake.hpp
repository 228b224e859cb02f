// Combines match tasks with the local maps that they name, and requests missing maps.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/search_pool/map_cache.hpp"
#include "topogeo/search_pool/match_job.hpp"

namespace topogeo::search_pool {

struct IntakeOptions {
  std::size_t map_bytes = std::size_t{32} << 20U;  ///< limit of all maps together
  /// Maps travel on another topic than the tasks that name them, so the newest one in a task may
  /// still be on its way, unless its robot has already published one of that time. Older ones,
  /// which were published before the worker started or are stored, and pieces of a whole map are
  /// requested at once.
  std::chrono::nanoseconds first_request = std::chrono::milliseconds(20);
  std::chrono::nanoseconds request_period = std::chrono::milliseconds(500);
  std::chrono::nanoseconds patience = std::chrono::seconds(2);  ///< with a missing map
};

/// Has no clock: the caller passes the time. Not thread-safe.
class TaskIntake {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A request for a map from a client.
  struct Request {
    std::string client_id;
    std::string robot_id;
    std::int64_t stamp_ns = 0;  ///< of a task that names it
    std::uint32_t map_id = 0;
    std::uint64_t content_hash = 0;
  };
  struct GivenUp {
    MatchJob job;
    std::string why;  ///< message for a user; names the map
  };
  struct Due {
    std::vector<Request> requests;
    std::vector<GivenUp> given_up;
  };

  explicit TaskIntake(const IntakeOptions& options = {})
      : options_(options), maps_(options.map_bytes) {}

  /// The job with its maps; empty if it waits for them.
  std::optional<ReadyJob> add(MatchJob job, Time now);
  /// Stores the map and returns the jobs that only lacked this one, oldest first.
  std::vector<ReadyJob> add_map(MapPointer map);
  /// Like add_map() for a map published by its robot. Tasks may name one of the newest by another
  /// number than the published one, when a localizer follows a stored map.
  std::vector<ReadyJob> add_published(MapPointer map);
  /// True if a job waits for a map with this content.
  [[nodiscard]] bool lacks(std::uint64_t content_hash) const;
  /// Work due at `now`: each missing map is requested once per period and client.
  Due check(Time now);
  /// Time of the next work for check(); empty without waiting jobs.
  [[nodiscard]] std::optional<Time> next_check() const;
  /// Removes the waiting jobs of a client that is gone.
  void remove(const std::string& client_id);

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] const MapCache& maps() const { return maps_; }

 private:
  /// A waiting job holds the maps that have arrived, so that none of them can be dropped before the
  /// other one arrives.
  struct Waiting {
    ReadyJob job;
    Time until;
  };
  struct Asking {
    Time next;           // time of the next request
    bool asked = false;  // at least once
  };
  using Lack = std::pair<std::string, std::uint64_t>;  // client and content

  template <class Action>  // (Lack, map id)
  static void for_each_lack(const ReadyJob& job, Action action);
  /// A map among the newest of a robot that has this content under this number; null if there is
  /// none.
  MapPointer find_by_other_number(const std::string& robot_id, std::uint32_t map_id,
                                  std::uint64_t content_hash);
  /// The map with this number, stored, if that gives it this content; otherwise null.
  MapPointer numbered_as_meant(const topomap::LocalMap& map, std::uint32_t map_id,
                               std::uint64_t content_hash);
  /// The map that a task names, or null.
  MapPointer find(const MatchJob& job, std::uint32_t map_id, std::uint64_t content_hash);
  /// True if the map of a task will no longer arrive unrequested.
  [[nodiscard]] bool is_past(const MatchJob& job) const;
  /// Drops requests for maps that no job waits for.
  void forget_requests();

  IntakeOptions options_;
  MapCache maps_;
  std::list<Waiting> waiting_;  // oldest first
  std::map<Lack, Asking> requested_;
  std::map<std::string, std::deque<MapPointer>> published_;  // by robot, latest first
};

}  // namespace topogeo::search_pool
