// The sessions, the stops as they were sent, and their numbers in the map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <SQLiteCpp/Database.h>
#include <SQLiteCpp/Statement.h>

#include "topogeo/storage/map_database.hpp"

namespace topogeo::storage {

/// Caches which stops are stored. If the transaction around a change fails, call read() to restore
/// the cache. All changes are parts of a transaction.
class StopTables {
 public:
  StopTables(SQLite::Database& database, std::string file);

  /// Reads which stops are stored. Throws std::runtime_error if they contradict each other.
  void read();
  /// Empties the cache.
  void forget();

  /// Like MapDatabase::put_stops. `are_over`: value for new sessions, see SessionState.
  std::vector<topomap::StopId> put(std::span<const topomap::LocalMap> stops, bool are_over);
  /// Like MapDatabase::join.
  void join(std::span<const JoinedStop> stops);
  /// Like MapDatabase::renew; no table may refer to numbers of the map.
  void renew(std::span<const JoinedStop> stops);
  /// Like MapDatabase::drop_session.
  void drop_session(std::uint64_t session);
  /// Like MapDatabase::drop_waiting.
  std::size_t drop_waiting(std::size_t most);

  /// The stops of a session from a number on, as they were sent.
  void for_each_of(std::uint64_t session, std::uint32_t first,
                   const std::function<void(topomap::LocalMap)>& visit) const;
  [[nodiscard]] std::size_t waiting_count() const;

  [[nodiscard]] std::optional<topomap::LocalMap> stop(const topomap::StopId& stop) const;
  /// The stops of the map under its numbers, in their order.
  void for_each(const std::function<void(topomap::LocalMap)>& visit) const;

  [[nodiscard]] bool knows(const topomap::StopId& stop) const;
  [[nodiscard]] std::vector<topomap::StopId> waiting() const;
  [[nodiscard]] std::vector<SessionState> sessions() const;
  [[nodiscard]] std::uint32_t joined() const { return joined_; }

 private:
  struct Session {
    std::int64_t place = 0;
    bool is_over = false;
    std::uint32_t joined = 0;         // stops in the map
    std::uint32_t kept_from = 0;      // stops below it that did not join were dropped
    std::set<std::uint32_t> stored;   // numbers above `gapless`
    std::uint32_t gapless = 0;        // all numbers below were received
    std::set<std::uint32_t> waiting;  // stored, not joined
  };
  Session& session(std::uint64_t id, bool is_over);
  void count(Session& session, std::uint32_t number);
  void remove(const topomap::StopId& stop);
  void keep_from(std::uint64_t session, std::uint32_t number);
  [[nodiscard]] bool is_same(const topomap::LocalMap& map) const;

  SQLite::Database& database_;
  std::string file_;
  std::map<std::uint64_t, Session> sessions_;
  std::uint32_t joined_ = 0;
};

}  // namespace topogeo::storage
