// Where a robot that maps an unknown floor goes next (own; future work in the Thesis, 9.2;
// docs/algorithms.md, "Exploration").
//
// The frontier are the ends of outer branches (fictitious nodes of the topo-geometric map) and,
// where the graph has none, stretches of free cells next to unknown ones. Doors and narrowings are
// gone to until both of their sides were seen, and every zone is entered once. A target is worth
// what unknown floor the robot could drive into from there: what shows through holes of walls and
// racks is worth nothing. The nearest targets are ordered by a short open tour, and its first one
// comes next. Nothing here moves the robot: the owner drives to a target and reports where it has
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
  kPassage = 1,    ///< a door or narrowing of which a side was not seen
  kGap = 2,        ///< free cells next to unknown ones
  kRoom = 3,       ///< a wide part of the floor that was never entered
  kBlocked = 4,    ///< a zone that was seen, but the map shows no path into it; often it does when
                   ///< the entrance is looked at from near, so these come last
};

/// A word for messages: "branch end", ...
std::string_view describe(TargetKind kind);

struct ExplorationTarget {
  TargetKind kind = TargetKind::kGap;
  Eigen::Vector2d position_m = Eigen::Vector2d::Zero();  ///< what is to be seen, map frame
  geometry::Pose2 T_map_view;  ///< where from: in a passable cell, looking at it
  double distance_m = 0.0;     ///< of the path there
};

class Explorer {
 public:
  /// Throws std::invalid_argument as `check`.
  explicit Explorer(const ExplorerConfig& config = {});

  /// Where the scans were made that the map consists of, in place of those set before.
  void set_visited(std::vector<geometry::Pose2> T_map_stops);

  /// The first target of a short tour past those that can be reached; nothing: the floor is
  /// explored. `planner` plans on `map`.
  [[nodiscard]] std::optional<ExplorationTarget> next(const topomap::GlobalMap& graph,
                                                      const planning::HybridMap& map,
                                                      const planning::HybridPlanner& planner,
                                                      const geometry::Pose2& T_map_robot) const;

  /// Whether there is still something to see at a target; false as soon as the map shows it.
  [[nodiscard]] bool open(const ExplorationTarget& target, const planning::HybridMap& map) const;

  /// It cannot be reached, or was looked at in vain: it does not come again.
  void give_up(const ExplorationTarget& target);
  [[nodiscard]] std::size_t given_up() const { return given_up_.size(); }

  /// There was no path to it when the robot wanted to go: it does not come again before the others
  /// are done, and the second time it is given up.
  void put_off(const ExplorationTarget& target);
  /// Takes the targets that were put off in again; false: there are none.
  bool resume();

 private:
  struct Candidate {
    TargetKind kind;
    Eigen::Vector2d position_m;
    double worth_m;  // longest path that it is worth
  };
  struct Option;
  struct Scene;  // what is planned on
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
