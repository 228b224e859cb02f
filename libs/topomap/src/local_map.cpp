#include "topogeo/topomap/local_map.hpp"

#include <cstring>

namespace topogeo::topomap {
namespace {

class Fnv1a {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_arithmetic_v<T>);
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 0x100000001b3ULL;
  }
  void add(const Eigen::Vector2d& v) {
    add(v.x());
    add(v.y());
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace

std::uint64_t content_hash(const LocalMap& map) {
  Fnv1a hash;
  hash.add(map.id);
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
    hash.add(static_cast<std::uint8_t>(n.kind));
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
    hash.add(b.points.size());
    for (const BranchPoint& p : b.points) {
      hash.add(p.position_m);
      hash.add(p.clearance_m);
    }
  }
  return hash.value();
}

}  // namespace topogeo::topomap
