// A year of patrol: growth of the map, and whether the last drive is as accurate as the first.
#include <algorithm>
#include <exception>
#include <filesystem>
#include <iostream>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/support/format.hpp"

#include "patrol_run.hpp"

int main(int argc, char** argv) {
  using namespace topogeo;
  command_line::Command app{"a year of patrol on one floor"};
  bench::PatrolOptions options;
  options.directory = std::filesystem::temp_directory_path() / "topogeo_patrol";
  std::size_t every = 25;
  app.add_option("--drives", options.drives, "drives of the year")->capture_default_str();
  app.add_option("--moves", options.drives_per_move, "drives until the cupboard is moved")
      ->capture_default_str();
  app.add_option("--people", options.people, "who walk about")->capture_default_str();
  app.add_option("--every", every, "drives from one line of the table to the next")
      ->capture_default_str();
  app.add_option("--out", options.directory, "folder of map.sqlite, which is made anew")
      ->type_name("DIR");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    std::cout << "| drive | stops | not joined | in the map | loops | nodes | rms m | rms of the "
                 "map m | file MB | memory MB | CPU s |\n"
                 "|---|---|---|---|---|---|---|---|---|---|---|\n";
    double worst_m = 0.0;
    const auto result =
        bench::run_patrol(options, pipeline::Config{}, [&](const bench::PatrolDrive& drive) {
          worst_m = std::max(worst_m, drive.rms_m);
          if (drive.drive > 3 && drive.drive % every != 0 && drive.drive != options.drives) return;
          std::cout << fmt::format(
                           "| {} | {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.1f} | {:.0f} | "
                           "{:.1f} |\n",
                           drive.drive, drive.stops, drive.unmapped, drive.map_stops, drive.loops,
                           drive.nodes, drive.rms_m, drive.map_rms_m,
                           static_cast<double>(drive.file_bytes) / 1e6, drive.memory_mb,
                           drive.cpu_s)
                    << std::flush;
        });
    std::cout << fmt::format(
        "\nworst drive {:.3f} m; the store has the map of the localizer: {}; {} occupied cells "
        "where the cupboard stands, {} where it stood\n",
        worst_m, result.same_in_store ? "yes" : "NO", result.cupboard_cells, result.ghosts);
    return result.same_in_store ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "topogeo_patrol: " << error.what() << '\n';
    return 1;
  }
}
