// Selects the next target of a robot that maps an unknown floor (own; future work in the Thesis,
// 9.2; docs/algorithms.md, "Exploration").
//
// The frontier consists of the ends of outer branches (fictitious nodes of the topo-geometric map)
// and, where the graph has none, of free cells next to unknown ones. Doors and narrowings are
// targets until both of their sides were seen, and every zone is entered once. The worth of a
// target is the unknown floor that the robot could drive into from there, so views through holes of
// walls and racks are worth nothing. The nearest targets are ordered by a short open tour, whose
// first one comes next. Nothing here moves the robot: the owner drives to a target and reports the
// visited poses.
// been.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "topogeo/geometry/pose2.hpp"
#include "topogeo/navigation/explorer_config.hpp"
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::navigation {

class Rooms;
class UnknownFloor;

enum class TargetKind : std::uint8_t {
  kBranchEnd = 0,  ///< of an outer branch
  kPassage = 1,    ///< a door or narrowing with an unseen side
  kGap = 2,        ///< free cells next to unknown ones
  kRoom = 3,       ///< a wide part of the floor that was never entered
  kBlocked = 4,    ///< a visible zone without a path into it on the map; a near view of the
                   ///< entrance often shows one, so these come last
};

/// A word for messages: "branch end", ...
std::string_view describe(TargetKind kind);

struct ExplorationTarget {
  TargetKind kind = TargetKind::kGap;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< the place to be seen, map frame
  geometry::Pose2 T_map_view;  ///< viewpoint: in a passable cell, facing the place
  double distance_m = 0.0;     ///< of the path there
};

class Explorer {
 public:
  /// Throws std::invalid_argument like `check`.
  explicit Explorer(const ExplorerConfig& config = {});

  /// Sets the poses of the scans that the map consists of, replacing earlier ones.
  void set_visited(std::vector<geometry::Pose2> T_map_stops);

  /// The first target of a short tour past the reachable ones; nothing: the floor is explored.
  /// `planner` plans on `map`.
  [[nodiscard]] std::optional<ExplorationTarget> next(const topomap::GlobalMap& graph,
                                                      const planning::HybridMap& map,
                                                      const planning::HybridPlanner& planner,
                                                      const geometry::Pose2& T_map_robot) const;

  /// Whether a target still has unseen parts; false as soon as the map shows them.
  [[nodiscard]] bool open(const ExplorationTarget& target, const planning::HybridMap& map) const;

  /// Excludes a target that cannot be reached, or whose visit showed nothing.
  void give_up(const ExplorationTarget& target);
  [[nodiscard]] std::size_t given_up() const { return given_up_.size(); }

  /// Postpones a target without a path until the others are done; the second time it is given up.
  void put_off(const ExplorationTarget& target);
  /// Restores the postponed targets; false if there are none.
  bool resume();

 private:
  struct Candidate {
    TargetKind kind;
    Eigen::Vector2d position_m;
    double worth_m;  // its worth as a path length
  };
  struct Option;
  struct Scene;  // inputs of planning
  [[nodiscard]] std::vector<Candidate> candidates(const topomap::GlobalMap& graph,
                                                  const planning::HybridMap& map,
                                                  const Rooms& rooms) const;
  [[nodiscard]] std::vector<Candidate> blocked_zones(const planning::HybridMap& map,
                                                     const std::vector<bool>& reachable) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> branch_ends(const topomap::GlobalMap& graph) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> passage_sides(const topomap::GlobalMap& graph,
                                                           const planning::HybridMap& map) const;
  [[nodiscard]] std::vector<Eigen::Vector2d> gaps(const planning::HybridMap& map,
                                                  const UnknownFloor& unknown) const;
  void add_rooms(const planning::HybridMap& map, const Rooms& rooms,
                 std::vector<Candidate>& found) const;
  [[nodiscard]] std::vector<Option> options(const std::vector<Candidate>& candidates,
                                            const Scene& scene) const;
  [[nodiscard]] std::optional<geometry::Pose2> view_of(const Candidate& candidate,
                                                       const Scene& scene) const;
  [[nodiscard]] bool dropped(TargetKind kind, const Eigen::Vector2d& position_m) const;

  ExplorerConfig config_;
  std::vector<geometry::Pose2> visited_;
  std::vector<ExplorationTarget> given_up_;
  std::vector<ExplorationTarget> put_off_;
  std::vector<ExplorationTarget> resumed_;
};

}  // namespace topogeo::navigation
