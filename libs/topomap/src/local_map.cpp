#include "topogeo/topomap/local_map.hpp"

#include <bit>
#include <concepts>
#include <cstdint>

#include "topogeo/support/hash.hpp"
#include "topogeo/topomap/odometry_contradiction.hpp"

namespace topogeo::topomap {
namespace {

class ContentHash {
 public:
  template <std::integral T>
  void add(T value) {
    hash_.add(static_cast<std::uint64_t>(value));
  }
  void add(double value) { hash_.add(std::bit_cast<std::uint64_t>(value)); }
  void add(float value) { hash_.add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  void add(const Eigen::Vector2d& v) {
    add(v.x());
    add(v.y());
  }
  [[nodiscard]] std::uint64_t value() const { return hash_.value(); }

 private:
  support::Fnv1a hash_;
};

}  // namespace

std::uint64_t content_hash(const LocalMap& map) {
  return content_hash(map, map.id);
}

std::uint64_t content_hash(const LocalMap& map, std::uint32_t id) {
  ContentHash hash;
  hash.add(id);
  hash.add(map.T_robot_laser.x_m);
  hash.add(map.T_robot_laser.y_m);
  hash.add(map.T_robot_laser.theta_rad);
  hash.add(map.points.size());
  for (const ScanPoint& p : map.points) {
    hash.add(p.x_m);
    hash.add(p.y_m);
  }
  hash.add(map.nodes.size());
  for (const LocalNode& n : map.nodes) {
    hash.add(static_cast<std::uint32_t>(n.kind));
    hash.add(n.position_m);
    hash.add(n.clearance_m);
    hash.add(n.in_main_graph);
  }
  hash.add(map.branches.size());
  for (const LocalBranch& b : map.branches) {
    hash.add(b.node_a);
    hash.add(b.node_b);
    hash.add(b.is_virtual);
    hash.add(b.in_main_graph);
    hash.add(b.confirmed);
    hash.add(b.points.size());
    for (const BranchPoint& p : b.points) {
      hash.add(p.position_m);
      hash.add(p.clearance_m);
    }
  }
  return hash.value();
}

bool has_odometry_between(const LocalMap& before, const LocalMap& after) {
  return !after.starts_drive && before.odometry_epoch == after.odometry_epoch &&
         !odometry_contradiction(before.T_odom_robot, after);
}

LocalMap numbered(LocalMap map, std::uint32_t id, bool starts_drive) {
  map.id = id;
  if (starts_drive) {
    map.starts_drive = true;
    map.track.clear();
    map.T_previous_robot = {};
  }
  return map;
}

}  // namespace topogeo::topomap
