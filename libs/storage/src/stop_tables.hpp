// The sessions, the stops as they were sent, and which number the map gave to which of them.
#pragma once

#include <cstddef>
#include <cstdint>
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

/// Remembers which stops there are. When the transaction around a change fails call read() to know
/// them again. All changes are parts of a transaction.
class StopTables {
 public:
  StopTables(SQLite::Database& database, std::string file);

  /// Reads which stops there are. Throws std::runtime_error when they contradict each other.
  void read();
  /// As if there were none.
  void forget();

  /// As MapDatabase::put_stops.
  std::vector<StopSource> put(std::span<const SessionStop> stops);
  /// As MapDatabase::join.
  void join(std::span<const JoinedStop> stops);
  /// As MapDatabase::drop_waiting.
  std::size_t drop_waiting(std::size_t most);

  [[nodiscard]] std::optional<SessionStop> stop(const StopSource& source) const;
  /// The stops of the map under its numbers, and where they come from.
  void load(MapDocument& document) const;

  [[nodiscard]] std::vector<StopSource> waiting() const;
  [[nodiscard]] std::vector<SessionState> sessions() const;
  [[nodiscard]] std::uint32_t joined() const { return joined_; }

 private:
  struct Session {
    std::int64_t place = 0;
    std::uint32_t kept_from = 0;      // below it, what has not joined was dropped
    std::set<std::uint32_t> stored;   // above `gapless`
    std::uint32_t gapless = 0;        // all numbers below came
    std::set<std::uint32_t> waiting;  // stored, not joined
  };
  Session& session(std::uint64_t id);
  void count(Session& session, std::uint32_t number);
  [[nodiscard]] bool is_same(const SessionStop& stop) const;

  SQLite::Database& database_;
  std::string file_;
  std::map<std::uint64_t, Session> sessions_;
  std::uint32_t joined_ = 0;
};

}  // namespace topogeo::storage
