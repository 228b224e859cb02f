#include "stop_tables.hpp"

#include <algorithm>
#include <stdexcept>
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
  SQLite::Statement session(database_, "SELECT place, id, kept_from FROM session");
  while (session.executeStep()) {
    Session& entry = sessions_[as_unsigned(integer_at(session, 1))];
    entry.place = integer_at(session, 0);
    entry.kept_from = number_at(session, 2, file_);
    entry.gapless = entry.kept_from;
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
    if (integer_at(row, 2) != 0) found->second.waiting.insert(number);
  }
  SQLite::Statement joined(database_, "SELECT count(*) FROM map_stop");
  joined.executeStep();
  joined_ = number_at(joined, 0, file_);
}

StopTables::Session& StopTables::session(std::uint64_t id) {
  const auto found = sessions_.find(id);
  if (found != sessions_.end()) return found->second;
  SQLite::Statement insert(database_, "INSERT INTO session(place, id, kept_from) VALUES(?, ?, 0)");
  const auto place = static_cast<std::int64_t>(sessions_.size());
  insert.bind(1, place);
  insert.bind(2, as_signed(id));
  insert.exec();
  Session& entry = sessions_[id];
  entry.place = place;
  return entry;
}

void StopTables::count(Session& session, std::uint32_t number) {
  if (number < session.gapless) return;
  session.stored.insert(number);
  while (session.stored.erase(session.gapless) != 0) ++session.gapless;
}

bool StopTables::is_same(const SessionStop& stop) const {
  SQLite::Statement row(database_,
                        "SELECT stamp_ns, content_hash FROM stop WHERE session = ? AND number = ?");
  row.bind(1, as_signed(stop.session));
  row.bind(2, stop.map.id);
  return !row.executeStep() ||  // dropped: whatever it was, it is of no use any more
         (integer_at(row, 0) == stop.map.stamp_ns &&
          as_unsigned(integer_at(row, 1)) == topomap::content_hash(stop.map));
}

std::vector<StopSource> StopTables::put(std::span<const SessionStop> stops) {
  std::vector<StopSource> different;
  SQLite::Statement insert(database_,
                           "INSERT INTO stop(session, number, odometry_epoch, stamp_ns, "
                           "content_hash, blob_hash, blob) VALUES(?, ?, ?, ?, ?, ?, ?)");
  for (const SessionStop& stop : stops) {
    Session& held = session(stop.session);
    const std::uint32_t number = stop.map.id;
    if (number < held.gapless || held.stored.contains(number)) {
      if (!is_same(stop)) different.push_back(stop.source());
      continue;
    }
    const std::string blob = to_blob<proto::LocalMap>(stop.map);
    insert.reset();
    insert.bind(1, as_signed(stop.session));
    insert.bind(2, number);
    insert.bind(3, as_signed(stop.odometry_epoch));
    insert.bind(4, stop.map.stamp_ns);
    insert.bind(5, as_signed(topomap::content_hash(stop.map)));
    insert.bind(6, as_signed(support::fnv1a(blob)));
    bind_blob(insert, 7, blob);
    insert.exec();
    count(held, number);
    held.waiting.insert(number);
  }
  return different;
}

void StopTables::join(std::span<const JoinedStop> stops) {
  SQLite::Statement insert(
      database_, "INSERT INTO map_stop(id, session, number, starts_drive) VALUES(?, ?, ?, ?)");
  for (const auto& [source, starts_drive] : stops) {
    const auto held = sessions_.find(source.session);
    if (held == sessions_.end() || held->second.waiting.erase(source.number) == 0) {
      throw std::invalid_argument(
          fmt::format("{}: stop {} of session {:016x} cannot join the map: it is not stored, or "
                      "is in the map",
                      file_, source.number, source.session));
    }
    insert.reset();
    insert.bind(1, joined_);
    insert.bind(2, as_signed(source.session));
    insert.bind(3, source.number);
    insert.bind(4, starts_drive ? 1 : 0);
    insert.exec();
    ++joined_;
  }
}

std::size_t StopTables::drop_waiting(std::size_t most) {
  const std::vector<StopSource> all = waiting();
  if (all.size() <= most) return 0;
  SQLite::Statement remove(database_, "DELETE FROM stop WHERE session = ? AND number = ?");
  SQLite::Statement mark(database_, "UPDATE session SET kept_from = ? WHERE id = ?");
  const std::size_t drops = all.size() - most;
  for (std::size_t i = 0; i < drops; ++i) {
    Session& held = sessions_.at(all[i].session);
    remove.reset();
    remove.bind(1, as_signed(all[i].session));
    remove.bind(2, all[i].number);
    remove.exec();
    held.waiting.erase(all[i].number);
    held.kept_from = all[i].number + 1;
    // What never came below counts as dropped, too.
    while (held.gapless < held.kept_from) count(held, held.gapless);
    mark.reset();
    mark.bind(1, held.kept_from);
    mark.bind(2, as_signed(all[i].session));
    mark.exec();
  }
  return drops;
}

std::optional<SessionStop> StopTables::stop(const StopSource& source) const {
  SQLite::Statement row(database_,
                        "SELECT number, blob_hash, blob, odometry_epoch FROM stop "
                        "WHERE session = ? AND number = ?");
  row.bind(1, as_signed(source.session));
  row.bind(2, source.number);
  if (!row.executeStep()) return std::nullopt;
  return SessionStop{source.session, as_unsigned(integer_at(row, 3)),
                     parse_row<proto::LocalMap>(row, file_, "stop")};
}

void StopTables::load(MapDocument& document) const {
  SQLite::Statement row(database_,
                        "SELECT m.id, s.blob_hash, s.blob, m.starts_drive, m.session, m.number "
                        "FROM map_stop m LEFT JOIN stop s "
                        "ON s.session = m.session AND s.number = m.number ORDER BY m.id");
  while (row.executeStep()) {
    const std::uint32_t id = number_at(row, 0, file_);
    const StopSource source{as_unsigned(integer_at(row, 4)), number_at(row, 5, file_)};
    if (row.getColumn(1).isNull()) {
      throw std::runtime_error(fmt::format("{}: damaged (stop {} of session {:016x} is missing)",
                                           file_, source.number, source.session));
    }
    topomap::LocalMap map = parse_row<proto::LocalMap>(row, file_, "stop");
    if (map.id != source.number) {
      throw std::runtime_error(
          fmt::format("{}: damaged (stop {} is stored as stop {})", file_, map.id, source.number));
    }
    document.local_maps.push_back(topomap::numbered(std::move(map), id, integer_at(row, 3) != 0));
    document.sources.push_back(source);
  }
}

std::vector<StopSource> StopTables::waiting() const {
  std::vector<std::pair<std::int64_t, StopSource>> ordered;
  for (const auto& [id, session] : sessions_) {
    for (const std::uint32_t number : session.waiting) {
      ordered.push_back({session.place, {id, number}});
    }
  }
  std::ranges::sort(ordered);
  std::vector<StopSource> out;
  out.reserve(ordered.size());
  for (const auto& entry : ordered) out.push_back(entry.second);
  return out;
}

std::vector<SessionState> StopTables::sessions() const {
  std::vector<std::pair<std::int64_t, SessionState>> ordered;
  ordered.reserve(sessions_.size());
  for (const auto& [id, session] : sessions_) {
    ordered.push_back({session.place, {id, session.gapless}});
  }
  std::ranges::sort(ordered, {}, [](const auto& entry) { return entry.first; });
  std::vector<SessionState> out;
  out.reserve(ordered.size());
  for (const auto& entry : ordered) out.push_back(entry.second);
  return out;
}

}  // namespace topogeo::storage
