// topogeo store snapshot, snapshots and restore: named copies of a map database.
#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/storage/map_snapshots.hpp"
#include "topogeo/support/format.hpp"

#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct SnapshotOptions {
  fs::path map;
  std::string name;
};

/// The database of a map store's directory; a file is returned unchanged.
fs::path database_of(const fs::path& map) {
  return fs::is_directory(map) ? map / "map.sqlite" : map;
}

void check_name(const std::string& name) {
  try {
    storage::check_snapshot_name(name);
  } catch (const std::invalid_argument& error) {
    throw service::UsageError(error.what());
  }
}

std::string utc_text(std::int64_t time_s) {
  const auto time = static_cast<std::time_t>(time_s);
  std::tm fields{};
  ::gmtime_r(&time, &fields);
  std::string text(32, '\0');
  text.resize(std::strftime(text.data(), text.size(), "%FT%TZ", &fields));
  return text;
}

std::string snapshot_line(const storage::MapSnapshot& snapshot) {
  const std::string head = fmt::format("{:24} {} {:>11} bytes  ", snapshot.name,
                                       utc_text(snapshot.time_s), snapshot.bytes);
  if (!snapshot.damage.empty()) return head + snapshot.damage;
  return head + fmt::format("map {:016x}  version {:>6}  {:>6} stops", snapshot.map_id,
                            snapshot.trajectory_version, snapshot.stops);
}

int store_snapshot(const SnapshotOptions& options) {
  check_name(options.name);
  const fs::path database = database_of(options.map);
  if (!looks_like_database(database)) {
    throw service::BadInputError(database.string() + ": no map database");
  }
  const storage::MapSnapshot taken = storage::take_snapshot(database, options.name);
  std::cout << snapshot_line(taken) << '\n' << taken.path.string() << '\n';
  return service::kOk;
}

void print_snapshots_json(const std::vector<storage::MapSnapshot>& snapshots) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const storage::MapSnapshot& snapshot : snapshots) {
    list.push_back({{"name", snapshot.name},
                    {"time_s", snapshot.time_s},
                    {"bytes", snapshot.bytes},
                    {"file", snapshot.path.string()},
                    {"damage", snapshot.damage},
                    {"map_id", fmt::format("{:016x}", snapshot.map_id)},
                    {"trajectory_version", snapshot.trajectory_version},
                    {"stops", snapshot.stops}});
  }
  std::cout << list.dump(2) << '\n';
}

int list_snapshots(const fs::path& map, bool json) {
  const std::vector<storage::MapSnapshot> found = storage::snapshots_of(database_of(map));
  if (json) {
    print_snapshots_json(found);
    return service::kOk;
  }
  for (const storage::MapSnapshot& snapshot : found) std::cout << snapshot_line(snapshot) << '\n';
  if (found.empty()) std::cerr << "topogeo: no snapshot of " << database_of(map).string() << '\n';
  return service::kOk;
}

int store_restore(const SnapshotOptions& options) {
  check_name(options.name);
  const fs::path database = database_of(options.map);
  const std::optional<storage::MapSnapshot> former =
      storage::restore_snapshot(database, options.name);
  std::cout << fmt::format("{}: restored from snapshot {}\n", database.string(), options.name);
  if (former) std::cout << "the previous map: " << snapshot_line(*former) << '\n';
  return service::kOk;
}

}  // namespace

void add_store_snapshot_commands(command_line::Command& store, int& exit_code) {
  constexpr const char* kMap = "directory of a map store (its --out), or the map database";
  constexpr const char* kName = "letters, digits, '.', '-' and '_'";
  command_line::Command* take = store.add_subcommand(
      "snapshot", "Copy a map database as a snapshot, even while it is written");
  auto taken = std::make_shared<SnapshotOptions>();
  take->add_option("map", taken->map, kMap)->required()->type_name("DIR");
  take->add_option("name", taken->name, kName)->required()->type_name("NAME");
  take->footer(
      "The copy is DIR/map.snapshots/NAME.sqlite: a database of its own that every command reads.");
  take->callback([taken, &exit_code] { exit_code = store_snapshot(*taken); });

  command_line::Command* list =
      store.add_subcommand("snapshots", "List the snapshots of a map database by time");
  auto listed = std::make_shared<fs::path>();
  auto json = std::make_shared<bool>(false);
  list->add_option("map", *listed, kMap)->required()->type_name("DIR");
  list->add_flag("--json", *json, "for programs: a list, empty without snapshots");
  list->callback([listed, json, &exit_code] { exit_code = list_snapshots(*listed, *json); });

  command_line::Command* restore =
      store.add_subcommand("restore", "Restore a map database from one of its snapshots");
  auto restored = std::make_shared<SnapshotOptions>();
  restore->add_option("map", restored->map, kMap)->required()->type_name("DIR");
  restore->add_option("name", restored->name, "snapshot")->required()->type_name("NAME");
  restore->footer(
      "Refused while a map store uses the database: stop it first. The previous map is kept as\n"
      "snapshot before-NAME. map.pb and pictures in DIR are updated when the next map store "
      "starts.");
  restore->callback([restored, &exit_code] { exit_code = store_restore(*restored); });
}

}  // namespace topogeo::cli
