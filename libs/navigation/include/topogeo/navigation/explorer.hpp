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
#include "topogeo/planning/hybrid_map.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/topomap/global_map.hpp"

namespace topogeo::navigation {

class Rooms;
class UnknownFloor;

struct ExplorerConfig {
  double unknown_near_m = 0.8;   ///< a target is open when unknown floor is this near, [0.1, 5]
  double sight_m = 4.0;          ///< what lies further behind a target is not counted,
                                 ///< [unknown_near_m, 20]
  double least_area_m2 = 0.2;    ///< less unknown floor is not gone to, [0, 100]
  double worth_m_per_m2 = 40.0;  ///< nor from so many times as far away, m per square metre of it,
                                 ///< [1, 10000]
  double passage_side_m =
      1.0;                  ///< where a side of a passage is looked at, from its middle, [0.3, 5]
  double gap_side_m = 1.0;  ///< borders of the known are counted in squares of this side, [0.3, 10]
  double least_gap_m = 0.3;  ///< shorter borders in a square are not gone to, [0.1, 10]
  double approach_m = 1.0;   ///< a target is looked at from this near, if there is room,
                             ///< [0.1, 10]
  double view_m = 3.0;       ///< or else from so far at most, [approach_m, 10]
  double sure_m = 0.35;      ///< nothing unknown is so near to where the robot is sent, [0, 2]
  double together_m = 1.5;   ///< targets seen from places nearer than this are one on the tour that
                             ///< decides on their order, [0, 10]
  std::size_t tour = 10;     ///< so many of the nearest targets are ordered, [1, 30]
  double least_room_m2 = 1.0;  ///< smaller rooms need not be entered, [0, 100]
};

/// Throws std::invalid_argument naming the field, the value and the range that it must lie in.
void check(const ExplorerConfig& config);

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
