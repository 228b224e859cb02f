// Holds the exact current map of robot "robot" and prints a line whenever it has changed.
#include <iostream>

#include "topogeo/map_client/map_reader.hpp"

int main() {
  topogeo::map_client::MapReader reader;
  while (true) {
    if (!reader.wait(std::chrono::minutes(1))) continue;
    const topogeo::map_client::Map& map = *reader.map();
    std::cout << "version " << map.version << ": " << map.nodes.size() << " nodes, "
              << map.branches.size() << " branches" << std::endl;
  }
}
