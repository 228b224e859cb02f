#include "stop_tables.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "topogeo/support/format.hpp"
#include "topogeo/support/hash.hpp"

#include "map_conversions.hpp"
#include "map_rows.hpp"
#include "sqlite_rows.hpp"
#include "table_writer.hpp"

namespace topogeo::storage {
namespace {

std::uint32_t number_at(const SQLite::Statement& row, int column, const std::string& file) {
  const std::int64_t number = integer_at(row, column);
  if (number >= 0 && number <= 0xffffffffLL) return static_cast<std::uint32_t>(number);
  throw std::runtime_error(fmt::format("{}: damaged (stop number {})", file, number));
}

}  // namespace

StopTables::StopTables(SQLite::Database& database, std::string file)
    : database_(database), file_(std::move(file)) {}

void StopTables::forget() {
  sessions_.clear();
  joined_ = 0;
}

void StopTables::read() {
  forget();
  SQLite::Statement session(database_, "SELECT place, id, kept_from, is_over FROM session");
  while (session.executeStep()) {
    Session& entry = sessions_[as_unsigned(integer_at(session, 1))];
    entry.place = integer_at(session, 0);
    entry.kept_from = number_at(session, 2, file_);
    entry.gapless = entry.kept_from;
    entry.is_over = integer_at(session, 3) != 0;
  }
  SQLite::Statement row(database_,
                        "SELECT s.session, s.number, m.id IS NULL FROM stop s "
                        "LEFT JOIN map_stop m ON m.session = s.session AND m.number = s.number "
                        "ORDER BY s.session, s.number");
  while (row.executeStep()) {
    const auto found = sessions_.find(as_unsigned(integer_at(row, 0)));
    if (found == sessions_.end()) {
      throw std::runtime_error(file_ + ": damaged (a stop of a session that is not there)");
    }
    const std::uint32_t number = number_at(row, 1, file_);
    count(found->second, number);
    if (integer_at(row, 2) != 0) {
      found->second.waiting.insert(number);
    } else {
      ++found->second.joined;
    }
  }
  SQLite::Statement joined(database_, "SELECT count(*) FROM map_stop");
  joined.executeStep();
  joined_ = number_at(joined, 0, file_);
}

StopTables::Session& StopTables::session(std::uint64_t id, bool is_over) {
  const auto found = sessions_.find(id);
  if (found != sessions_.end()) return found->second;
  SQLite::Statement insert(database_,
                           "INSERT INTO session(place, id, kept_from, is_over) VALUES(?, ?, 0, ?)");
  const auto place = static_cast<std::int64_t>(sessions_.size());
  insert.bind(1, place);
  insert.bind(2, as_signed(id));
  insert.bind(3, is_over ? 1 : 0);
  insert.exec();
  Session& entry = sessions_[id];
  entry.place = place;
  entry.is_over = is_over;
  return entry;
}

void StopTables::count(Session& session, std::uint32_t number) {
  if (number < session.gapless) return;
  session.stored.insert(number);
  while (session.stored.erase(session.gapless) != 0) ++session.gapless;
}

bool StopTables::knows(const topomap::StopId& stop) const {
  const auto held = sessions_.find(stop.session);
  return held != sessions_.end() &&
         (stop.number < held->second.gapless || held->second.stored.contains(stop.number));
}

bool StopTables::is_same(const topomap::LocalMap& map) const {
  SQLite::Statement row(database_,
                        "SELECT stamp_ns, content_hash FROM stop WHERE session = ? AND number = ?");
  row.bind(1, as_signed(map.stop.session));
  row.bind(2, map.stop.number);
  return !row.executeStep() ||  // dropped: its content no longer matters
         (integer_at(row, 0) == map.stamp_ns &&
          as_unsigned(integer_at(row, 1)) == topomap::content_hash(map));
}

std::vector<topomap::StopId> StopTables::put(std::span<const topomap::LocalMap> stops,
                                             bool are_over) {
  std::vector<topomap::StopId> different;
  SQLite::Statement insert(database_,
                           "INSERT INTO stop(session, number, stamp_ns, content_hash, "
                           "blob_hash, blob) VALUES(?, ?, ?, ?, ?, ?)");
  for (const topomap::LocalMap& given : stops) {
    const auto [id, number] = given.stop;
    Session& held = session(id, are_over);
    const topomap::LocalMap map = topomap::numbered(given, number, false);  // as it was sent
    if (knows(given.stop)) {
      if (!is_same(map)) different.push_back(given.stop);
      continue;
    }
    const std::string blob = to_blob<proto::LocalMap>(map);
    insert.reset();
    insert.bind(1, as_signed(id));
    insert.bind(2, number);
    insert.bind(3, map.stamp_ns);
    insert.bind(4, as_signed(topomap::content_hash(map)));
    insert.bind(5, as_signed(support::fnv1a(blob)));
    bind_blob(insert, 6, blob);
    insert.exec();
    count(held, number);
    held.waiting.insert(number);
    if (held.is_over && !are_over) {
      database_.exec("UPDATE session SET is_over = 0 WHERE place = " + std::to_string(held.place));
      held.is_over = false;
    }
  }
  return different;
}

void StopTables::join(std::span<const JoinedStop> stops) {
  SQLite::Statement insert(
      database_, "INSERT INTO map_stop(id, session, number, starts_drive) VALUES(?, ?, ?, ?)");
  for (const auto& [stop, starts_drive] : stops) {
    const auto held = sessions_.find(stop.session);
    if (held == sessions_.end() || held->second.waiting.erase(stop.number) == 0) {
      throw std::invalid_argument(
          fmt::format("{}: stop {} of session {:016x} cannot join the map: it is not stored, or "
                      "it joined already",
                      file_, stop.number, stop.session));
    }
    insert.reset();
    insert.bind(1, joined_);
    insert.bind(2, as_signed(stop.session));
    insert.bind(3, stop.number);
    insert.bind(4, starts_drive ? 1 : 0);
    insert.exec();
    ++joined_;
    ++held->second.joined;
  }
}

std::size_t StopTables::drop_waiting(std::size_t most) {
  const std::vector<topomap::StopId> all = waiting();
  if (all.size() <= most) return 0;
  const std::size_t drops = all.size() - most;
  for (std::size_t i = 0; i < drops; ++i) {
    remove(all[i]);
    keep_from(all[i].session, all[i].number + 1);
  }
  return drops;
}

void StopTables::drop_session(std::uint64_t session) {
  const auto held = sessions_.find(session);
  if (held == sessions_.end()) return;
  while (!held->second.waiting.empty()) {
    const std::uint32_t number = *held->second.waiting.begin();
    remove({session, number});
    keep_from(session, number + 1);
  }
}

void StopTables::remove(const topomap::StopId& stop) {
  SQLite::Statement row(database_, "DELETE FROM stop WHERE session = ? AND number = ?");
  row.bind(1, as_signed(stop.session));
  row.bind(2, stop.number);
  row.exec();
  sessions_.at(stop.session).waiting.erase(stop.number);
}

void StopTables::keep_from(std::uint64_t session, std::uint32_t number) {
  Session& held = sessions_.at(session);
  if (number <= held.kept_from) return;
  held.kept_from = number;
  // Numbers below that were never received count as dropped, too.
  while (held.gapless < held.kept_from) count(held, held.gapless);
  SQLite::Statement mark(database_, "UPDATE session SET kept_from = ? WHERE id = ?");
  mark.bind(1, number);
  mark.bind(2, as_signed(session));
  mark.exec();
}

void StopTables::renew(std::span<const JoinedStop> stops) {
  std::set<topomap::StopId> leaving;
  std::map<std::uint64_t, std::uint32_t> decided;  // by session: all numbers below
  SQLite::Statement row(database_, "SELECT session, number FROM map_stop");
  while (row.executeStep()) {
    leaving.insert({as_unsigned(integer_at(row, 0)), number_at(row, 1, file_)});
  }
  row.reset();
  database_.exec("DELETE FROM map_stop");
  joined_ = 0;
  for (const topomap::StopId& stop : leaving) {
    Session& held = sessions_.at(stop.session);
    held.waiting.insert(stop.number);
    held.joined = 0;
    decided[stop.session] = stop.number + 1;
  }
  join(stops);
  for (const JoinedStop& joined : stops) leaving.erase(joined.stop);
  for (const topomap::StopId& stop : leaving) remove(stop);
  for (const auto& [session, number] : decided) {
    const std::set<std::uint32_t>& waiting = sessions_.at(session).waiting;
    while (!waiting.empty() && *waiting.begin() < number) remove({session, *waiting.begin()});
    keep_from(session, number);
  }
}

std::optional<topomap::LocalMap> StopTables::stop(const topomap::StopId& stop) const {
  SQLite::Statement row(
      database_, "SELECT number, blob_hash, blob FROM stop WHERE session = ? AND number = ?");
  row.bind(1, as_signed(stop.session));
  row.bind(2, stop.number);
  if (!row.executeStep()) return std::nullopt;
  return parse_row<proto::LocalMap>(row, file_, "stop");
}

void StopTables::for_each(const std::function<void(topomap::LocalMap)>& visit) const {
  SQLite::Statement row(database_,
                        "SELECT m.id, s.blob_hash, s.blob, m.starts_drive, m.session, m.number "
                        "FROM map_stop m LEFT JOIN stop s "
                        "ON s.session = m.session AND s.number = m.number ORDER BY m.id");
  while (row.executeStep()) {
    const std::uint32_t id = number_at(row, 0, file_);
    const topomap::StopId stop{as_unsigned(integer_at(row, 4)), number_at(row, 5, file_)};
    if (row.getColumn(1).isNull()) {
      throw std::runtime_error(fmt::format("{}: damaged (stop {} of session {:016x} is missing)",
                                           file_, stop.number, stop.session));
    }
    topomap::LocalMap map = parse_row<proto::LocalMap>(row, file_, "stop");
    if (map.stop != stop) {
      throw std::runtime_error(fmt::format("{}: damaged (stop {} is stored as stop {})", file_,
                                           map.stop.number, stop.number));
    }
    visit(topomap::numbered(std::move(map), id, integer_at(row, 3) != 0));
  }
}

void StopTables::for_each_of(std::uint64_t session, std::uint32_t first,
                             const std::function<void(topomap::LocalMap)>& visit) const {
  SQLite::Statement row(database_,
                        "SELECT number, blob_hash, blob FROM stop "
                        "WHERE session = ? AND number >= ? ORDER BY number");
  row.bind(1, as_signed(session));
  row.bind(2, first);
  while (row.executeStep()) visit(parse_row<proto::LocalMap>(row, file_, "stop"));
}

std::size_t StopTables::waiting_count() const {
  std::size_t count = 0;
  for (const auto& [id, session] : sessions_) count += session.waiting.size();
  return count;
}

std::vector<topomap::StopId> StopTables::waiting() const {
  std::vector<std::pair<std::int64_t, topomap::StopId>> ordered;
  for (const auto& [id, session] : sessions_) {
    for (const std::uint32_t number : session.waiting) {
      ordered.emplace_back(session.place, topomap::StopId{id, number});
    }
  }
  std::ranges::sort(ordered);
  std::vector<topomap::StopId> out;
  out.reserve(ordered.size());
  for (const auto& entry : ordered) out.push_back(entry.second);
  return out;
}

std::vector<SessionState> StopTables::sessions() const {
  std::vector<std::pair<std::int64_t, SessionState>> ordered;
  ordered.reserve(sessions_.size());
  for (const auto& [id, session] : sessions_) {
    ordered.push_back(
        {session.place, {id, session.gapless, session.kept_from, session.joined, session.is_over}});
  }
  std::ranges::sort(ordered, {}, [](const auto& entry) { return entry.first; });
  std::vector<SessionState> out;
  out.reserve(ordered.size());
  for (const auto& entry : ordered) out.push_back(entry.second);
  return out;
}

}  // namespace topogeo::storage
