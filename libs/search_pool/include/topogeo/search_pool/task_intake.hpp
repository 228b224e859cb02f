// Brings match tasks and the local maps that they name together, and asks for maps that do not
// come.
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
  std::size_t map_bytes = std::size_t{32} << 20U;  ///< that all maps together may take
  /// Maps travel on another topic than the tasks that name them, so the newest that a task names
  /// may come soon, unless its robot has published one of that time already. Older ones, which were
  /// published before the worker came or are stored, and pieces of a whole map are asked for at
  /// once.
  std::chrono::nanoseconds first_request = std::chrono::milliseconds(20);
  std::chrono::nanoseconds request_period = std::chrono::milliseconds(500);
  std::chrono::nanoseconds patience = std::chrono::seconds(2);  ///< with a map that lacks
};

/// Has no clock: the caller passes the time. Not safe for several threads.
class TaskIntake {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A map that a client is to send.
  struct Request {
    std::string client_id;
    std::string robot_id;
    std::int64_t stamp_ns = 0;  ///< of a task that names it
    std::uint32_t map_id = 0;
    std::uint64_t content_hash = 0;
  };
  struct GivenUp {
    MatchJob job;
    std::string why;  ///< for people, names the map
  };
  struct Due {
    std::vector<Request> requests;
    std::vector<GivenUp> given_up;
  };

  explicit TaskIntake(const IntakeOptions& options = {})
      : options_(options), maps_(options.map_bytes) {}

  /// The job with its maps, or nothing: then it waits for them.
  std::optional<ReadyJob> add(MatchJob job, Time now);
  /// Keeps the map and returns the jobs that have waited for it alone, oldest first.
  std::vector<ReadyJob> add_map(MapPointer map);
  /// The same of a map that its robot has published. Tasks may name one of the newest by another
  /// number than it was published with, as a localizer does that follows a stored map.
  std::vector<ReadyJob> add_published(MapPointer map);
  /// True when a job waits for a map of this content.
  [[nodiscard]] bool lacks(std::uint64_t content_hash) const;
  /// What is to be done at `now`: each map that lacks is asked for once per period and client.
  Due check(Time now);
  /// When check() has something to do next; nothing while no job waits.
  [[nodiscard]] std::optional<Time> next_check() const;
  /// Takes out the waiting jobs of a client that is gone.
  void remove(const std::string& client_id);

  [[nodiscard]] std::size_t waiting() const { return waiting_.size(); }
  [[nodiscard]] const MapCache& maps() const { return maps_; }

 private:
  /// A job holds the maps that are there already, so that none of them can be dropped again before
  /// the other one comes.
  struct Waiting {
    ReadyJob job;
    Time until;
  };
  struct Asking {
    Time next;           // when to ask (again)
    bool asked = false;  // already
  };
  using Lack = std::pair<std::string, std::uint64_t>;  // client and content

  template <class Action>  // (Lack, map id)
  static void for_each_lack(const ReadyJob& job, Action action);
  /// A map of this content among the newest of a robot, if they had this number; or nothing.
  MapPointer find_by_other_number(const std::string& robot_id, std::uint32_t map_id,
                                  std::uint64_t content_hash);
  /// The map with this number, kept, if that makes it the one that is meant; or nothing.
  MapPointer numbered_as_meant(const topomap::LocalMap& map, std::uint32_t map_id,
                               std::uint64_t content_hash);
  /// The map that a task names, if it is there.
  MapPointer find(const MatchJob& job, std::uint32_t map_id, std::uint64_t content_hash);
  /// True when the map of a task will not come by itself any more.
  [[nodiscard]] bool is_past(const MatchJob& job) const;
  /// Forgets the requests for maps that no job waits for any more.
  void forget_requests();

  IntakeOptions options_;
  MapCache maps_;
  std::list<Waiting> waiting_;  // oldest first
  std::map<Lack, Asking> requested_;
  std::map<std::string, std::deque<MapPointer>> published_;  // by robot, the last one first
};

}  // namespace topogeo::search_pool
