// Occupied cells reported to the planner, until they are seen free or are too old.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "topogeo/navigation/navigator_inputs.hpp"
#include "topogeo/planning/occupancy_grid.hpp"

namespace topogeo::navigation {

class Blockade {
 public:
  explicit Blockade(double kept_s) : kept_ns_(static_cast<std::int64_t>(kept_s * 1e9)) {}

  /// Adds the cells of these points; true if one of them is new.
  bool add(std::span<const Eigen::Vector2d> points_m, const planning::GridFrame& frame,
           std::int64_t now_ns);
  /// Checks the cells in a scan; `T_map_robot` at its time.
  void see(const ScanPoints& scan, const geometry::Pose2& T_map_robot);
  /// Removes cells that were seen free or are too old.
  void expire(std::int64_t now_ns);
  void clear();
  /// Asks the planner again although nothing has changed.
  void ask_again() { ++report_.version; }

  [[nodiscard]] const BlockageReport& report() const { return report_; }
  [[nodiscard]] bool empty() const { return cells_.empty(); }

 private:
  struct Filled {
    Eigen::Vector2d point_m;
    std::int64_t last_ns;
    int free = 0;  ///< consecutive observations as free
  };
  void publish();

  std::int64_t kept_ns_;
  std::vector<Filled> cells_;
  BlockageReport report_;
};

}  // namespace topogeo::navigation
