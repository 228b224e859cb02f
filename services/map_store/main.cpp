// Keeps the map of a robot in a directory and shows it to everybody.
#include <exception>
#include <memory>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/atomic_file.hpp"

#include "map_store_service.hpp"
#include "result_files.hpp"

namespace {

void check_directory(const std::filesystem::path& directory) {
  try {
    topogeo::support::check_writable_directory(directory);
  } catch (const std::exception& error) {
    throw topogeo::service::BadInputError(error.what());
  }
}

std::shared_ptr<const topogeo::storage::MapDocument> map_to_continue(
    const std::optional<std::filesystem::path>& file, const topogeo::service::Setup& setup) {
  if (!file) return nullptr;
  try {
    return topogeo::pipeline::load_map_to_continue(*file, setup.config.config,
                                                   setup.options.robot_id);
  } catch (const std::exception& error) {
    throw topogeo::service::BadInputError(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace topogeo;  // NOLINT(google-build-using-namespace)
  map_store::MapStoreOptions options;
  std::optional<std::filesystem::path> continued;
  const auto add_options = [&](CLI::App& app) {
    app.add_option("--out", options.directory, "directory of the results, made if missing")
        ->required();
    app.add_option(
        "--database", options.database,
        "map database; replaced when it is of an earlier run; default: map.sqlite there");
    app.add_option("--continue", continued,
                   "map.pb that is extended, as given to the localizer; it stays as it is")
        ->type_name("FILE");
    app.add_option("--title", options.title, "title of the pictures; default: the robot's name");
  };
  return service::run_service(
      argc, argv, "map_store", "Stores local maps and trajectory and makes the global map.",
      add_options, [&](const service::Setup& setup) {
        options.continued = map_to_continue(continued, setup);
        check_directory(options.directory);
        if (options.database.empty()) options.database = options.directory / "map.sqlite";
        if (options.title.empty()) options.title = setup.options.robot_id;
        storage::MapDatabase database = map_store::fresh_database(
            options.database, setup.options.robot_id, setup.config.config.localizer.seed);
        service::Service service(setup);
        const map_store::MapStoreService store(service, options, std::move(database));
        service.run();
      });
}
