#include "result_files.hpp"

#include <exception>
#include <vector>

#include "topogeo/results/outputs.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/format.hpp"

namespace topogeo::map_store {

namespace fs = std::filesystem;

void set_aside_database(const fs::path& path) {
  if (!fs::exists(path)) return;
  try {
    if (!fs::is_empty(path)) storage::MapDatabase::check_replaceable(path);
  } catch (const std::exception& error) {
    throw service::BadInputError(std::string(error.what()) +
                                 "; move it away or name another file with --database");
  }
  try {
    // The map of the previous run is kept once, so that a mistaken restart does not destroy it. The
    // write-ahead log is empty here, because opening the database above has merged it.
    fs::path previous = path;
    previous.replace_extension(".previous" + path.extension().string());
    fs::rename(path, previous);
    for (const char* suffix : {"-wal", "-shm"}) fs::remove(path.string() + suffix);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
}

storage::MapDatabase last_database(const fs::path& path, const std::string& robot_id,
                                   std::uint64_t seed) {
  try {
    return storage::MapDatabase::open_or_create(path, robot_id, seed);
  } catch (const std::exception& error) {
    throw service::BadInputError(std::string(error.what()) +
                                 "; name another file with --database, or start once with --new, "
                                 "which sets this map aside");
  }
}

void begin_with(storage::MapDatabase& database, const storage::MapDocument& continued) {
  try {
    if (database.sessions().empty()) database.put_document(continued);
  } catch (const std::exception& error) {
    throw service::BadInputError(error.what());
  }
  const std::uint64_t expected = storage::identified(continued).map_id;
  if (database.map_id() == expected) return;
  throw service::BadInputError(fmt::format(
      "the map database holds map {:016x}, expected {:016x} of --continue; omit --continue to "
      "resume the database, or start once with --new, which sets it aside",
      database.map_id(), expected));
}

void write_results(const fs::path& directory, const storage::MapDocument& document,
                   const std::string& title) {
  const fs::path unfinished = directory / ".unfinished";
  fs::remove_all(unfinished);
  fs::create_directory(unfinished);
  results::write_map_outputs(unfinished, document, title);
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(unfinished)) {
    if (entry.path().filename() != "map.pb") names.push_back(entry.path().filename());
  }
  names.emplace_back("map.pb");
  for (const fs::path& name : names) fs::rename(unfinished / name, directory / name);
  fs::remove(unfinished);
}

}  // namespace topogeo::map_store
