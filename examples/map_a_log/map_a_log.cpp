// Makes a map from a CARMEN log in this process, without DDS: map_a_log LOG DIRECTORY. Its map.pb
// and trajectory.tum are those of `topogeo map`, byte for byte.
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/recording/log_reader.hpp"
#include "topogeo/results/outputs.hpp"
#include "topogeo/scan/laser_mounting.hpp"

namespace {

void map_log(const std::filesystem::path& log, const std::filesystem::path& directory) {
  // The defaults of all settings; the log states where the laser sits on the robot.
  topogeo::pipeline::LoadedConfig loaded = topogeo::pipeline::load_config(std::nullopt);
  const std::string note =
      topogeo::pipeline::choose_mounting(loaded, topogeo::scan::mounting_in_log(log));
  if (!note.empty()) std::cerr << note << '\n';

  // Readings of the value that the laser reports for no echo are not walls.
  topogeo::recording::LogReader reader(log, loaded.config.log);
  if (reader.no_return()) std::cerr << text_of(*reader.no_return()) << '\n';
  topogeo::pipeline::MappingRun run(loaded.config, "robot");
  while (const std::optional<topogeo::scan::Scan> scan = reader.next()) run.add(*scan);
  const topogeo::storage::MapDocument map = run.finish();

  std::filesystem::create_directories(directory);
  topogeo::results::write_map_outputs(directory, map, log.filename().string());
  std::cout << map.local_maps.size() << " stops, " << map.global_map.nodes.size() << " nodes, "
            << map.global_map.branches.size() << " branches\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "expected: map_a_log LOG DIRECTORY\n";
    return 2;
  }
  try {
    map_log(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "map_a_log: " << error.what() << '\n';
    return 1;
  }
}
