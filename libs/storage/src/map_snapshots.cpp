#include "topogeo/storage/map_snapshots.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <tuple>
#include <utility>

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/Database.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include "topogeo/storage/map_database.hpp"
#include "topogeo/support/file_descriptor.hpp"
#include "topogeo/support/format.hpp"

#include "map_schema.hpp"
#include "sqlite_rows.hpp"

namespace topogeo::storage {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kSnapshotSuffix = ".sqlite";

fs::path snapshot_folder(const fs::path& database) {
  fs::path folder = database;
  return folder.replace_extension(".snapshots");
}

fs::path snapshot_path(const fs::path& database, const std::string& name) {
  check_snapshot_name(name);
  return snapshot_folder(database) / (name + std::string(kSnapshotSuffix));
}

fs::path existing_snapshot(const fs::path& database, const std::string& name) {
  fs::path path = snapshot_path(database, name);
  if (!fs::exists(path)) throw std::runtime_error("there is no snapshot " + name);
  return path;
}

/// Removes a file and those that SQLite may leave beside it.
void remove_with_logs(const fs::path& path) {
  for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
    std::error_code ignored;
    fs::remove(path.string() + suffix, ignored);
  }
}

void copy_pages(SQLite::Database& to, SQLite::Database& from) {
  SQLite::Backup backup(to, from);
  const int result = backup.executeStep(-1);
  if (result != SQLITE_DONE) throw SQLite::Exception("database is locked", result);
}

/// Forces a file or folder to disk.
void sync(const fs::path& path) {
  const support::FileDescriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open() || ::fsync(file.get()) != 0) {
    throw std::runtime_error(
        path.string() + ": cannot be synced to disk: " + std::generic_category().message(errno));
  }
}

MapSnapshot described(const fs::path& path) {
  MapSnapshot snapshot;
  snapshot.name = path.stem().string();
  snapshot.path = path;
  try {
    snapshot.bytes = fs::file_size(path);
    const auto age = fs::file_time_type::clock::now() - fs::last_write_time(path);
    const auto time = std::chrono::system_clock::now().time_since_epoch() - age;
    snapshot.time_s = std::chrono::round<std::chrono::seconds>(time).count();
    const MapDatabase map = MapDatabase::open_read_only(path);
    snapshot.map_id = map.map_id();
    snapshot.trajectory_version = map.trajectory_version();
    snapshot.stops = map.local_map_count();
  } catch (const std::exception& error) {
    snapshot.damage = error.what();
  }
  return snapshot;
}

/// Copies an open database to the file, which then exists whole or not at all.
MapSnapshot write_snapshot(SQLite::Database& from, const fs::path& path) {
  fs::create_directories(path.parent_path());
  // Only one program at a time makes a snapshot here; remains of a killed one are removed.
  const support::FileDescriptor folder(
      ::open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (!folder.is_open() || ::flock(folder.get(), LOCK_EX) != 0) {
    throw std::runtime_error(path.parent_path().string() +
                             ": cannot be locked: " + std::generic_category().message(errno));
  }
  if (fs::exists(path)) throw std::runtime_error(path.string() + ": this snapshot exists already");
  const fs::path unfinished = path.parent_path() / ".unfinished.sqlite";
  remove_with_logs(unfinished);
  try {
    {
      SQLite::Database copy(unfinished.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
      copy_pages(copy, from);
      copy.exec("PRAGMA journal_mode=DELETE");  // the file needs no log
    }
    MapSnapshot snapshot = described(unfinished);
    if (!snapshot.damage.empty()) throw std::runtime_error(snapshot.damage);
    sync(unfinished);
    fs::rename(unfinished, path);
    sync(path.parent_path());
    snapshot.name = path.stem().string();
    snapshot.path = path;
    return snapshot;
  } catch (...) {
    remove_with_logs(unfinished);
    throw;
  }
}

/// An unused name for the former map.
std::string name_before(const fs::path& database, const std::string& name) {
  constexpr std::size_t kLongestName = 56;  // leaves room for a number
  const std::string wanted = ("before-" + name).substr(0, kLongestName);
  std::string free = wanted;
  for (int number = 2; fs::exists(snapshot_path(database, free)); ++number) {
    free = fmt::format("{}-{}", wanted, number);
  }
  return free;
}

[[noreturn]] void throw_in_use(const fs::path& database) {
  throw std::runtime_error(database.string() +
                           ": a map store or another program has it open; stop it and try again");
}

/// Whether another process has the file open as an SQLite database, intact or not: SQLite locks
/// bytes from 2^30 on (https://www.sqlite.org/fileformat2.html, "The Lock-Byte Page"). Not for
/// files that this process has open itself: closing a file releases the process's locks on it.
bool is_locked(const fs::path& path) {
  const support::FileDescriptor file(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  if (!file.is_open()) return false;
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = 0x40000000;
  lock.l_len = 512;
  return ::fcntl(file.get(), F_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

/// Opens the database exclusively: while a map store has it open, it cannot leave the write-ahead
/// log. Empty if it is damaged.
std::unique_ptr<SQLite::Database> open_alone(const fs::path& path) {
  constexpr int kPatience_ms = 500;  // a reader may be at work
  std::unique_ptr<SQLite::Database> database;
  try {
    database = open_map_database(path, Access::kCreate);
    database->setBusyTimeout(kPatience_ms);
    const std::string mode = database->execAndGet("PRAGMA locking_mode=EXCLUSIVE").getString();
    const std::string log = database->execAndGet("PRAGMA journal_mode=DELETE").getString();
    if (mode != "exclusive" || log != "delete") throw_in_use(path);
    // Takes the lock and keeps it.
    database->exec("BEGIN EXCLUSIVE; COMMIT");
    const std::string verdict = database->execAndGet("PRAGMA quick_check(1)").getString();
    return verdict == "ok" ? std::move(database) : nullptr;
  } catch (const SQLite::Exception& error) {
    switch (error.getErrorCode()) {
      case SQLITE_BUSY:
      case SQLITE_LOCKED:
        throw_in_use(path);
      case SQLITE_NOTADB:
      case SQLITE_CORRUPT:
        return nullptr;
      default:
        throw;
    }
  }
}

/// Moves a damaged database away, with its log.
MapSnapshot set_aside(const fs::path& database, const fs::path& snapshot) {
  fs::create_directories(snapshot.parent_path());
  if (fs::exists(database.string() + "-wal")) {
    fs::rename(database.string() + "-wal", snapshot.string() + "-wal");
  }
  fs::rename(database, snapshot);
  remove_with_logs(database);
  return described(snapshot);
}

bool is_damaged_start(const fs::path& database) {
  try {
    static_cast<void>(open_map_database(database, Access::kReadOnly));
    return false;
  } catch (const SQLite::Exception& error) {
    return error.getErrorCode() == SQLITE_NOTADB || error.getErrorCode() == SQLITE_CORRUPT;
  } catch (const std::runtime_error&) {
    return true;
  }
}

}  // namespace

void check_snapshot_name(std::string_view name) {
  constexpr std::string_view kAllowed =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  if (!name.empty() && name.size() <= 64 && name.front() != '.' &&
      name.find_first_not_of(kAllowed) == std::string_view::npos) {
    return;
  }
  throw std::invalid_argument(fmt::format(
      "snapshot name '{}': expected 1 to 64 letters, digits, '.', '-' and '_', not '.' first",
      name));
}

std::vector<MapSnapshot> snapshots_of(const fs::path& database) {
  std::vector<MapSnapshot> found;
  const fs::path folder = snapshot_folder(database);
  if (!fs::is_directory(folder)) return found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string file = entry.path().filename().string();
    if (file.front() == '.' || !file.ends_with(kSnapshotSuffix)) continue;
    found.push_back(described(entry.path()));
  }
  std::ranges::sort(found, [](const MapSnapshot& a, const MapSnapshot& b) {
    return std::tie(a.time_s, a.name) < std::tie(b.time_s, b.name);
  });
  return found;
}

MapSnapshot take_snapshot(const fs::path& database, const std::string& name) try {
  const fs::path path = snapshot_path(database, name);
  if (!fs::exists(database)) throw std::runtime_error(database.string() + ": there is no such map");
  const auto state = [&] {
    return std::pair(fs::exists(database.string() + "-wal"), fs::last_write_time(database));
  };
  while (true) {
    const auto before = state();
    MapSnapshot snapshot = [&] {
      const auto source = open_map_database(database, Access::kReadOnly);
      return write_snapshot(*source, path);
    }();
    // Without a log the file was read as immutable, so a map store that has started meanwhile may
    // have changed it.
    if (before.first || state() == before) return snapshot;
    remove_with_logs(path);
  }
} catch (const SQLite::Exception& error) {
  throw_named(database.string(), error);
} catch (const fs::filesystem_error& error) {
  throw std::runtime_error(error.what());
}

MapSnapshot import_snapshot(const fs::path& database, const std::string& name,
                            const MapDocument& map) try {
  const fs::path path = snapshot_path(database, name);
  const MapDatabase own = MapDatabase::open_read_only(database);
  if (map.robot_id != own.robot_id() || map.seed != own.seed()) {
    throw std::runtime_error(
        fmt::format("it is the map of robot '{}' with seed {}, expected '{}' with seed {}",
                    map.robot_id, map.seed, own.robot_id(), own.seed()));
  }
  const fs::path made = path.parent_path() / ".imported.sqlite";
  fs::create_directories(made.parent_path());
  remove_with_logs(made);  // left by a killed program
  try {
    MapDatabase::open_or_create(made, map.robot_id, map.seed).put_document(map);
    MapSnapshot snapshot = write_snapshot(*open_map_database(made, Access::kReadOnly), path);
    remove_with_logs(made);
    return snapshot;
  } catch (...) {
    remove_with_logs(made);
    throw;
  }
} catch (const SQLite::Exception& error) {
  throw_named(database.string(), error);
} catch (const fs::filesystem_error& error) {
  throw std::runtime_error(error.what());
}

void remove_snapshot(const fs::path& database, const std::string& name) {
  const fs::path path = existing_snapshot(database, name);
  remove_with_logs(path);
  sync(path.parent_path());
}

void rename_snapshot(const fs::path& database, const std::string& name,
                     const std::string& new_name) {
  const fs::path path = existing_snapshot(database, name);
  const fs::path wanted = snapshot_path(database, new_name);
  // A link fails where there is a file of the name, a rename replaces it.
  if (::link(path.c_str(), wanted.c_str()) != 0) {
    throw std::runtime_error(errno == EEXIST ? "there is a snapshot " + new_name + " already"
                                             : wanted.string() + ": " + std::strerror(errno));
  }
  remove_with_logs(path);
  sync(path.parent_path());
}

std::optional<MapSnapshot> restore_snapshot(
    const fs::path& database, const std::string& name,
    const std::function<void(std::string_view)>& after) try {
  const fs::path path = snapshot_path(database, name);
  if (!fs::exists(path)) throw std::runtime_error(path.string() + ": there is no such snapshot");
  if (const MapSnapshot wanted = described(path); !wanted.damage.empty()) {
    throw std::runtime_error(wanted.damage);
  }
  const auto source = open_map_database(path, Access::kReadOnly);
  std::optional<MapSnapshot> former;
  const bool there = fs::exists(database);
  if (there && is_locked(database)) throw_in_use(database);
  std::unique_ptr<SQLite::Database> target;
  if (!there || !is_damaged_start(database)) target = open_alone(database);
  const fs::path kept = snapshot_path(database, name_before(database, name));
  if (!target) {
    former = set_aside(database, kept);
    after("former map set aside");
    target = open_alone(database);
    if (!target) throw std::runtime_error(database.string() + ": cannot be created again");
  } else if (has_content(*target)) {
    former = write_snapshot(*target, kept);
    after("former map kept");
  }
  copy_pages(*target, *source);
  after("restored");
  return former;
} catch (const SQLite::Exception& error) {
  throw_named(database.string(), error);
} catch (const fs::filesystem_error& error) {
  throw std::runtime_error(error.what());
}

}  // namespace topogeo::storage
