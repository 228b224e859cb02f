// Unmapped objects near the robot: seen by the laser, met by the collision guard, or reported to
// the planner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/free_space.hpp"

#include "blockade.hpp"
#include "branch_detour.hpp"
#include "contact_memory.hpp"
#include "obstacle_memory.hpp"
#include "pose_keeper.hpp"

namespace topogeo::navigation {

/// Standing obstacles first, then those that may move away.
struct SeenObstacles {
  std::vector<Eigen::Vector2d> points_m;  ///< map frame
  std::size_t standing = 0;
  std::optional<SeenScan> scan;  ///< the newest

  [[nodiscard]] std::span<const Eigen::Vector2d> standing_m() const {
    return std::span(points_m).first(standing);
  }
};

class Surroundings {
 public:
  explicit Surroundings(double blockage_s) : blockade_(blockage_s) {}

  /// A scan for the next update(), because its pose may still come.
  void add(const ScanPoints& scan);
  /// The collision guard has stopped before an obstacle there, map frame.
  void add_contact(const Eigen::Vector2d& contact_m, std::int64_t now_ns) {
    contacts_.add(contact_m, now_ns);
  }

  /// Call once per step: evaluates the scans since the last call. `space` null: there is no map, or
  /// no pose.
  void update(const planning::FreeSpace* space, const PoseKeeper& poses, std::int64_t now_ns);

  /// Forgets all places, because the pose was wrong or the map has changed.
  void forget();
  void forget_contacts() { contacts_.clear(); }

  [[nodiscard]] SeenObstacles seen(std::int64_t now_ns) const;

  /// Reports the occupied cells around a point (map frame); the planner answers again in any case.
  void report(const Eigen::Vector2d& around_m, double reach_m, const planning::GridFrame& frame,
              std::int64_t now_ns);
  [[nodiscard]] const BlockageReport& blockages() const { return blockade_.report(); }
  [[nodiscard]] bool anything_reported() const { return !blockade_.empty(); }

 private:
  ObstacleMemory memory_{MemoryConfig{}};
  ContactMemory contacts_;
  Blockade blockade_;
  std::vector<ScanPoints> scans_;
  std::optional<SeenScan> newest_;
};

}  // namespace topogeo::navigation
