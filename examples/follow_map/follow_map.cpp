// Holds the exact current map of robot "robot" and prints a line whenever it has changed.
#include <iostream>

#include "topogeo/map_client/map_reader.hpp"

int main() {
  const topogeo::map_client::MapReaderOptions options;  // robot "robot", TOPOGEO_DOMAIN
  topogeo::map_client::MapReader reader(options);
  while (true) {
    if (!reader.wait(std::chrono::seconds(2))) {
      if (reader.stores() > 0) continue;
      std::cerr << "no map store of robot '" << options.robot_id << "' on domain " << options.domain
                << ", partition '" << options.partition << "'\n";
      continue;
    }
    const topogeo::map_client::Map& map = *reader.map();
    std::cout << "version " << map.version << ": " << map.nodes.size() << " nodes, "
              << map.branches.size() << " branches" << std::endl;
  }
}
