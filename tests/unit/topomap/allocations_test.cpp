// Counts the allocations for a scan: this program replaces operator new.
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

#include "counted_allocations.hpp"
#include "voronoi/test_world.hpp"

namespace topogeo {
namespace {

using test::allocations;

class Perception {
 public:
  void see(const scan::Scan& scan) {
    voronoi_.compute(scan, diagram_);
    builder_.build(diagram_, scan, {}, map_);
  }
  [[nodiscard]] const topomap::LocalMap& map() const { return map_; }

 private:
  voronoi::LocalVoronoi voronoi_{voronoi::VoronoiConfig{}};
  voronoi::LocalVoronoiDiagram diagram_;
  topomap::LocalMapBuilder builder_{topomap::LocalMapConfig{}};
  topomap::LocalMap map_;
};

std::vector<scan::Scan> scans() {
  std::vector<scan::Scan> all;
  for (std::uint32_t seed = 0; seed < 60; ++seed) {
    all.push_back(test_world::scan_of(test_world::random_world(seed)));
  }
  all.push_back(test_world::scan_of({}));  // a virtual diagram
  return all;
}

TEST(Allocations, AScanCostsNoneOnceThePerceptionIsWarm) {
  const std::vector<scan::Scan> all = scans();
  Perception perception;
  for (int round = 0; round < 30; ++round) {
    for (const scan::Scan& scan : all) perception.see(scan);
  }
  std::size_t branches = 0;
  const std::size_t before = allocations;
  for (const scan::Scan& scan : all) {
    perception.see(scan);
    branches += perception.map().branches.size();
  }
  EXPECT_EQ(allocations - before, 0U);
  EXPECT_GT(branches, 50U);
}

TEST(Allocations, TheFirstScanOfAGeometryAllocates) {
  const scan::Scan scan = test_world::scan_of(test_world::random_world(1));
  const std::size_t before = allocations;
  Perception perception;
  perception.see(scan);
  EXPECT_GT(allocations - before, 20U);
}

}  // namespace
}  // namespace topogeo
