#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <vector>

#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/topomap/local_map.hpp"
#include "topogeo/topomap/local_map_builder.hpp"
#include "topogeo/voronoi/local_voronoi.hpp"

#include "checks.hpp"
#include "memory_file.hpp"

namespace topogeo::fuzz {
namespace {

// A few kilobytes of gzip hold thousands of scans, and all of them take the same code path.
constexpr int kMaxScans = 64;
constexpr std::size_t kMaxMaps = 3;

/// Guarantees of the reader for every scan that it returns.
class ScanPromises {
 public:
  void check(const scan::Scan& scan) {
    require(scan.sequence == count_, "sequence numbers count from 0 without gaps");
    require(count_ == 0 || scan.stamp_ns > last_ns_, "stamps increase strictly");
    require(scan.ranges_m.size() >= 2 && scan.ranges_m.size() <= scan::CarmenLogReader::kMaxBeams,
            "the beam count is in range");
    require(std::isfinite(scan.angle_min_rad) && scan.angle_step_rad > 0.0, "angles are usable");
    require(
        std::ranges::all_of(scan.ranges_m, [](float r) { return std::isfinite(r) && r >= 0.0F; }),
        "ranges are finite and not negative");
    const geometry::Pose2& pose = scan.T_odom_robot;
    require(std::isfinite(pose.x_m) && std::isfinite(pose.y_m) && std::isfinite(pose.theta_rad),
            "the odometry is finite");
    require(
        count_ == 0 || (scan.ranges_m.size() == beams_ && scan.angle_min_rad == angle_min_rad_ &&
                        scan.angle_step_rad == angle_step_rad_),
        "every scan has the geometry of the first");
    ++count_;
    last_ns_ = scan.stamp_ns;
    beams_ = scan.ranges_m.size();
    angle_min_rad_ = scan.angle_min_rad;
    angle_step_rad_ = scan.angle_step_rad;
  }

 private:
  std::uint64_t count_ = 0;
  std::int64_t last_ns_ = 0;
  std::size_t beams_ = 0;
  double angle_min_rad_ = 0.0;
  double angle_step_rad_ = 0.0;
};

void check_node(const topomap::LocalNode& node, std::size_t index) {
  require(node.id == index, "the id of a node is its index");
  require(node.position_m.allFinite(), "node positions are finite");
  require(std::isfinite(node.clearance_m) && node.clearance_m >= 0.0,
          "node clearances are finite and not negative");
  require(node.base_groups.size() >= 2, "a node has two base groups or more");
  require(std::ranges::adjacent_find(node.base_groups, std::ranges::greater_equal{}) ==
              node.base_groups.end(),
          "base groups ascend");
}

void check_branch(const topomap::LocalBranch& branch, std::size_t index,
                  const topomap::LocalMap& map) {
  require(branch.id == index, "the id of a branch is its index");
  require(branch.node_a < map.nodes.size() && branch.node_b < map.nodes.size(),
          "a branch ends at nodes of the map");
  require(branch.points.size() >= 2, "a branch has two points or more");
  for (const topomap::BranchPoint& point : branch.points) {
    require(point.position_m.allFinite(), "branch points are finite");
    require(std::isfinite(point.clearance_m) && point.clearance_m >= 0.0,
            "branch clearances are finite and not negative");
  }
  const topomap::LocalNode& a = map.nodes[branch.node_a];
  const topomap::LocalNode& b = map.nodes[branch.node_b];
  require(branch.points.front().position_m == a.position_m, "a branch starts at its first node");
  require(branch.points.back().position_m == b.position_m, "a branch ends at its last node");
  for (const topomap::LocalNode* node : {&a, &b}) {
    require(std::ranges::includes(node->base_groups, branch.base_groups),
            "the nodes of a branch share its base groups");
    require(node->in_main_graph == branch.in_main_graph,
            "a branch and its nodes are in the main graph together");
  }
}

void check_map(const topomap::LocalMap& map, std::size_t beams) {
  for (std::size_t i = 0; i < map.nodes.size(); ++i) check_node(map.nodes[i], i);
  for (std::size_t i = 0; i < map.branches.size(); ++i) check_branch(map.branches[i], i, map);
  require(map.points.size() <= beams, "a beam gives one scan point at most");
  for (const topomap::ScanPoint& point : map.points) {
    require(std::isfinite(point.x_m) && std::isfinite(point.y_m), "scan points are finite");
  }
}

/// A sixteenth of the default number of cells: a default diagram costs more than everything else.
voronoi::VoronoiConfig coarse() {
  voronoi::VoronoiConfig config;
  config.range_limit_m = 5.0;
  config.resolution_m = 0.1;
  return config;
}

topomap::LocalMap map_of(const scan::Scan& scan, voronoi::LocalVoronoi& diagrams) {
  topomap::LocalMapConfig config;
  config.points_range_m = diagrams.config().range_limit_m;
  topomap::LocalMap map;
  topomap::build_local_map(diagrams.compute(scan), scan, {}, config, map);
  return map;
}

std::optional<scan::CarmenLogReader> open(const MemoryFile& file) {
  try {
    return scan::CarmenLogReader(file.path());
  } catch (const std::runtime_error&) {
    return std::nullopt;
  }
}

}  // namespace

std::size_t check_carmen_log(std::string_view bytes) {
  const MemoryFile file(bytes);
  std::optional<scan::CarmenLogReader> reader = open(file);
  if (!reader) return 0;
  ScanPromises promises;
  voronoi::LocalVoronoi diagrams(coarse());
  std::size_t maps = 0;
  for (int i = 0; i < kMaxScans; ++i) {
    const std::optional<scan::Scan> scan = reader->next();
    if (!scan) break;
    promises.check(*scan);
    if (maps == kMaxMaps) continue;
    const topomap::LocalMap map = map_of(*scan, diagrams);
    check_map(map, scan->ranges_m.size());
    if (++maps == kMaxMaps) {
      voronoi::LocalVoronoi fresh(diagrams.config());
      require(content_hash(map) == content_hash(map_of(*scan, fresh)),
              "the map depends on the scan alone, not on those before it");
    }
  }
  require(maps > 0, "a log that opens has a scan");
  return maps;
}

}  // namespace topogeo::fuzz
