// Keeps the map of a robot in a directory and shows it to all readers.
#include <array>
#include <chrono>
#include <csignal>
#include <exception>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <malloc.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/service/sole_service.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/storage/read_map.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/file_lock.hpp"
#include "topogeo/support/log.hpp"

#include "disk_room.hpp"
#include "drawing_options.hpp"
#include "map_server.hpp"
#include "map_store_service.hpp"
#include "result_files.hpp"

using namespace topogeo;  // NOLINT(google-build-using-namespace)

namespace {

void check_directory(const std::filesystem::path& directory) {
  try {
    support::check_writable_directory(directory);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

/// Locks the results and the database: map.lock beside map.sqlite and map.pb, and another lock
/// beside a database elsewhere. The lock files stay until the process ends.
std::vector<support::FileLock> lock(const map_store::MapStoreOptions& store) {
  // A killed map store needs a moment to release its memory and files.
  constexpr std::chrono::seconds kPatience{1};
  std::set<std::filesystem::path> paths = {store.directory / "map.lock"};
  paths.insert(std::filesystem::path(store.database).replace_extension(".lock"));
  std::vector<support::FileLock> locks;
  try {
    for (const std::filesystem::path& path : paths) locks.emplace_back(path, kPatience);
  } catch (const std::exception& error) {
    throw service::BadInputError(std::string(error.what()) + "; is another map store running?");
  }
  return locks;
}

std::shared_ptr<const storage::MapDocument> map_to_continue(
    const std::optional<std::filesystem::path>& file, const service::Setup& setup) {
  if (!file) return nullptr;
  try {
    return pipeline::load_map_to_continue(*file, setup.config.config, setup.options.robot_id);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

struct StoreOptions {
  map_store::MapStoreOptions store;
  bool anew = false;
  std::optional<std::filesystem::path> continued;
  std::optional<std::filesystem::path> map;
  map_store::DrawingOptions drawing;
  std::vector<std::string> robots;

  /// Only shows an existing map and takes nothing in.
  [[nodiscard]] bool serves() const { return map || (drawing.drawing && store.directory.empty()); }
};

void add_options(command_line::Command& app, StoreOptions& options) {
  map_store::MapStoreOptions& store = options.store;
  app.add_option(
      "--out", store.directory,
      "directory of the results, created if missing; required without --map and --drawing");
  app.add_option("--database", store.database,
                 "map database to resume or create; default: map.sqlite in --out");
  app.add_flag("--new", options.anew,
               "begin a new map; the existing database is kept as NAME.previous.sqlite, which "
               "replaces an older one");
  app.add_option("--continue", options.continued,
                 "map (map.pb or map.sqlite) that the new map extends, the same as for the "
                 "localizer; the file is not changed")
      ->type_name("FILE");
  app.add_option("--title", store.title, "title of the pictures; default: the robot's name");
  app.add_option("--map", options.map,
                 "map (map.pb or map.sqlite) to publish read-only: no input is processed, no "
                 "result written")
      ->type_name("FILE");
  add_drawing_options(app, options.drawing);
  service::add_robots_option(app, options.robots);
}

/// Shows a stored map, a drawing, or both.
void serve(const service::Setup& setup, const StoreOptions& options) {
  if (options.continued || options.anew || !options.store.directory.empty()) {
    throw service::UsageError(
        "--map publishes a read-only map: expected no --out, --new or --continue");
  }
  const pipeline::HybridMapConfig& config = setup.config.config.hybrid_map;
  storage::MapDrawing drawing = read_drawing(options.drawing, config.grid.resolution_m);
  storage::MapDocument document;
  const auto hybrid = [&] {
    try {
      if (options.map) {
        document = storage::read_map(*options.map);
        storage::add_verdicts_of_report(document, *options.map);
      }
      pipeline::lay_over(document.drawing, std::move(drawing));
      return pipeline::make_hybrid_map(pipeline::parts_of(document), config);
    } catch (const std::exception& error) {
      throw service::BadInputError(error.what());
    }
  }();
  service::Service service(setup);
  const service::SoleService sole(service);
  const map_store::MapServer server(service, std::move(document), hybrid);
  service.run();
}

/// Runs until the program must end, or until a snapshot replaces the map: returns its name then.
std::optional<std::string> keep_until_restored(const service::Setup& setup, StoreOptions& options) {
  const map_store::MapStoreOptions& store = options.store;
  service::Service service(service::with_robots(setup, options.robots));
  const service::SoleService sole(service);
  const std::uint64_t seed = setup.config.config.localizer.seed;
  if (options.anew) map_store::set_aside_database(store.database);
  options.anew = false;  // only once, even when the start is retried
  storage::MapDatabase database =
      map_store::last_database(store.database, setup.options.robot_id, seed);
  if (store.continued) map_store::begin_with(database, *store.continued);
  map_store::MapStoreService running(service, store, std::move(database));
  service.run();
  if (running.wanted_snapshot() && !service::Service::stopping()) return running.wanted_snapshot();
  running.end();
  return std::nullopt;
}

/// Keeps the map in its directory until the program must end.
void keep_in_directory(const service::Setup& setup, StoreOptions& options) {
  map_store::MapStoreOptions& store = options.store;
  check_directory(store.directory);
  const std::vector<support::FileLock> locks = lock(store);
  while (const auto snapshot = keep_until_restored(setup, options)) {
    storage::restore_snapshot(store.database, *snapshot);
    spdlog::info("restored snapshot {}", *snapshot);
    store.continued.reset();
  }
}

/// Does the same, but waits when the disk is full: systemd does not restart a program that ends
/// with kBadInput.
void keep_in_spite_of_full_disk(const service::Setup& setup, StoreOptions& options) {
  const std::array directories = {options.store.directory,
                                  std::filesystem::absolute(options.store.database).parent_path()};
  // A file that must not grow any more means a full disk and must not kill the process.
  std::signal(SIGXFSZ, SIG_IGN);
  for (bool had_room = false;;) {
    try {
      return keep_in_directory(setup, options);
    } catch (const std::exception& error) {
      const bool room = map_store::have_room(directories);
      const bool bad_input = dynamic_cast<const service::BadInputError*>(&error) != nullptr;
      if (service::Service::stopping() || (room && (had_room || !bad_input))) throw;
      had_room = room;  // retry: room may just have become free
      if (!room && !map_store::wait_for_room(setup, directories, error.what())) return;
    }
  }
}

/// Keeps the map of a drive.
void keep(const service::Setup& setup, StoreOptions options) {
  map_store::MapStoreOptions& store = options.store;
  if (store.directory.empty()) {
    throw service::UsageError("--out is required (or --map or --drawing, see --help)");
  }
  storage::MapDrawing drawing =
      read_drawing(options.drawing, setup.config.config.hybrid_map.grid.resolution_m);
  store.continued = map_to_continue(options.continued, setup);
  store.drawing = std::move(drawing);
  if (store.database.empty()) store.database = store.directory / "map.sqlite";
  if (store.title.empty()) store.title = setup.options.robot_id;
  keep_in_spite_of_full_disk(setup, options);
}

/// Returns large blocks to the system at once, such as those for drawing the live map or making a
/// snapshot. The heap would keep blocks of up to 32 MB, with small live blocks between them: 310 MB
/// instead of 257 MB with the map of topogeo_map_store_bench.
void give_back_large_blocks() {
  constexpr int kLarge_bytes = 256 * 1024;
  ::mallopt(M_MMAP_THRESHOLD, kLarge_bytes);
}

}  // namespace

int main(int argc, char** argv) {
  give_back_large_blocks();
  StoreOptions options;
  return service::run_service(
      argc, argv, "map_store", "Stores local maps and trajectory and makes the global map.",
      [&](command_line::Command& app) { add_options(app, options); },
      [&](const service::Setup& setup) {
        options.serves() ? serve(setup, options) : keep(setup, options);
      });
}
