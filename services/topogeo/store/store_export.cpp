// topogeo store export: writes a map in the format of another program.
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/exchange/map_export.hpp"
#include "topogeo/service/service_options.hpp"
#include "topogeo/support/host.hpp"

#include "common/configuration.hpp"
#include "store/format_list.hpp"
#include "store/store_commands.hpp"
#include "store/store_files.hpp"

namespace topogeo::cli {
namespace {

namespace fs = std::filesystem;

struct ExportOptions {
  fs::path file;
  std::string format;
  fs::path out;
  std::optional<fs::path> config;
  exchange::ExportSettings settings;
};

int store_export(ExportOptions options) {
  options.settings.hybrid_map = read_config(options.config).hybrid_map;
  options.settings.title = options.file.filename().string();
  options.settings.header.stamp_ns = support::wall_clock_ns();
  const storage::MapDocument map = read_any_map(options.file);
  try {
    const exchange::ExportedMap exported =
        exchange::export_map(map, options.format, options.out, options.settings);
    print_notes(exported.notes);
    exchange::write_files(exported.files);
  } catch (const std::invalid_argument& error) {
    throw service::BadInputError(options.file.string() + ": " + error.what());
  }
  return service::kOk;
}

}  // namespace

void add_store_export_command(command_line::Command& store, int& exit_code) {
  command_line::Command* command =
      store.add_subcommand("export", "Write a map in the format of another program");
  auto options = std::make_shared<ExportOptions>();
  command->add_option("file", options->file, "map file or database")->required()->type_name("FILE");
  const std::span<const exchange::MapFormat> formats = exchange::export_formats();
  command->add_option("--format", options->format, "format to write, see below")
      ->required()
      ->check(command_line::one_of(names_of(formats)))
      ->type_name("FORMAT");
  command->add_option("--out", options->out, "file to write, or the common prefix of several")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--config", options->config, "configuration (YAML), for its hybrid_map section")
      ->type_name("FILE");
  constexpr double kWidest_m = 10.0;
  command
      ->add_option("--robot-radius", options->settings.robot_radius_m,
                   "for graphs: leave out edges too narrow for this radius, metres; default: the "
                   "forbidden distance to obstacles of the configuration")
      ->check(command_line::range(0.0, kWidest_m))
      ->type_name("M");
  command
      ->add_option("--tolerance", options->settings.network.tolerance_m,
                   "for graphs: largest distance of a straight edge from its branch, metres")
      ->check(command_line::range(0.0, 1.0))
      ->capture_default_str()
      ->type_name("M");
  command->add_flag("--with-virtual", options->settings.network.with_virtual,
                    "for graphs: include all branches that no scan has seen, not only those that "
                    "alone join parts of the graph");
  command->add_flag("--only-free", options->settings.network.only_free,
                    "for graphs: leave out edges that the grid forbids");
  command
      ->add_option("--map-id", options->settings.header.map_id,
                   "for lif, zones and rmf: name of the map for robots and fleet managers")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--level", options->settings.header.level,
                   "for lif and rmf: level of the building")
      ->capture_default_str()
      ->type_name("NAME");
  command
      ->add_option("--manufacturer", options->settings.header.manufacturer,
                   "for lif and zones: author of the file")
      ->capture_default_str()
      ->type_name("NAME");
  command->footer(help_of(formats, &exchange::MapFormat::write_help) +
                  "docs/exchange.md names what each format keeps and loses.");
  command->callback([options, &exit_code] { exit_code = store_export(*options); });
}

}  // namespace topogeo::cli
