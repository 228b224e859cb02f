#include "navigation_floors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <utility>

#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/grid_search.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/cpu_time.hpp"

namespace topogeo::bench {
namespace {

using planning::Cell;

constexpr double kSight_m = 4.0;
constexpr std::uint64_t kLoopsSeed = 5;

/// Free space that a tour has seen.
class Seen {
 public:
  explicit Seen(const planning::FreeSpace& space)
      : space_(space), seen_(space.frame().size(), false) {}

  [[nodiscard]] bool at(std::size_t index) const { return seen_[index]; }

  void look_from(const Cell& from) {
    const planning::GridFrame& frame = space_.frame();
    const auto reach = static_cast<std::int32_t>(kSight_m / frame.resolution_m);
    for (std::int32_t row = from.row - reach; row <= from.row + reach; ++row) {
      for (std::int32_t column = from.column - reach; column <= from.column + reach; ++column) {
        const Cell to{column, row};
        if (!space_.passable(to) || seen_[frame.index(to)]) continue;
        const double length = std::hypot(column - from.column, row - from.row);
        if (length <= reach && free_between(from, to, length)) seen_[frame.index(to)] = true;
      }
    }
  }

 private:
  [[nodiscard]] bool free_between(const Cell& from, const Cell& to, double length) const {
    for (double along = 0.0; along < length; along += 0.7) {
      const double share = along / length;
      const Cell cell{
          static_cast<std::int32_t>(std::lround(from.column + share * (to.column - from.column))),
          static_cast<std::int32_t>(std::lround(from.row + share * (to.row - from.row)))};
      if (space_.grid().at(cell) != planning::CellState::kFree) return false;
    }
    return true;
  }

  const planning::FreeSpace& space_;
  std::vector<bool> seen_;
};

/// The cells that a robot can reach, the widest first, so that a tour stops in the middle of rooms.
std::vector<Cell> reachable_cells(const planning::FreeSpace& space, const Cell& start) {
  const planning::ZoneMap parts = planning::drawn_zones(space, {});
  const planning::ZoneId part = parts.zone_of_cell[space.frame().index(start)];
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < space.frame().size(); ++i) {
    if (parts.zone_of_cell[i] == part) cells.push_back(space.frame().cell_at(i));
  }
  std::stable_sort(cells.begin(), cells.end(), [&](const Cell& a, const Cell& b) {
    return space.squared_cells(space.frame().index(a)) >
           space.squared_cells(space.frame().index(b));
  });
  return cells;
}

/// Stops from which, together, everything is seen.
std::vector<Cell> visits(const planning::FreeSpace& space, const Cell& start) {
  Seen seen(space);
  seen.look_from(start);
  std::vector<Cell> stops;
  constexpr std::int32_t kLeast = 20;  // squared cells: corners are not worth a visit
  for (const Cell& cell : reachable_cells(space, start)) {
    const std::size_t index = space.frame().index(cell);
    if (seen.at(index) || space.squared_cells(index) < kLeast) continue;
    stops.push_back(cell);
    seen.look_from(cell);
  }
  return stops;
}

void drive_to(const planning::FreeSpace& space, const Cell& to,
              std::vector<Eigen::Vector2d>& tour_m) {
  const planning::HybridRoute route =
      planning::plan_on_grid(space, tour_m.back(), space.frame().center_m(to));
  if (!route.found()) throw std::runtime_error("tour: " + route.reason);
  if (route.points_m.size() < 2) return;
  tour_m.insert(tour_m.end(), route.points_m.begin() + 1, route.points_m.end());
}

}  // namespace

simulation::OdometryDrift drift_of(Wheels wheels, std::uint64_t seed) {
  return wheels == Wheels::kB21 ? simulation::b21_odometry(seed) : simulation::OdometryDrift{};
}

simulation::RobotOptions b21_robot(const geometry::Pose2& T_world_start,
                                   const geometry::Pose2& T_robot_laser, Wheels wheels,
                                   double slip_per_m, std::uint64_t seed) {
  simulation::RobotOptions robot;
  robot.seed = seed;
  robot.T_world_start = T_world_start;
  robot.T_robot_laser = T_robot_laser;
  robot.acceleration_m_per_s2 = 0.5;
  robot.angular_acceleration_rad_per_s2 = 2.0;
  robot.odometry = drift_of(wheels, seed);
  robot.slip.per_m = slip_per_m;
  return robot;
}

world::World navigation_floor(std::string_view name) {
  if (name == kNavigationFloors[0]) {
    return world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/floor.world.yaml");
  }
  if (name == kNavigationFloors[1]) {
    return world::load_world(TOPOGEO_SOURCE_DIR "/share/worlds/hall.world.yaml");
  }
  if (name == kNavigationFloors[2]) return simulation::two_loops(kLoopsSeed);
  throw std::invalid_argument("floor '" + std::string(name) +
                              "': expected office, warehouse or two loops");
}

std::vector<Eigen::Vector2d> tour_of_everything(const world::World& world) {
  const planning::FreeSpace space(planning::grid_of(pipeline::drawing_of(world)));
  const Eigen::Vector2d start_m = world.tour_m.front();
  const std::optional<Cell> start = space.frame().cell_of(start_m);
  if (!start || !space.passable(*start)) throw std::runtime_error(world.name + ": start of tour");
  std::vector<Cell> open = visits(space, *start);
  std::vector<Eigen::Vector2d> tour_m{start_m};
  const planning::SearchWindow window(space, planning::whole(space.frame()));
  Cell here = *start;
  while (!open.empty()) {  // on to the nearest
    const auto paths = planning::shortest_paths(window, here, open);
    const auto nearest = std::min_element(
        paths.begin(), paths.end(),
        [](const auto& a, const auto& b) { return a->cost_cells < b->cost_cells; });
    here = open[static_cast<std::size_t>(nearest - paths.begin())];
    open.erase(open.begin() + (nearest - paths.begin()));
    drive_to(space, here, tour_m);
  }
  drive_to(space, *start, tour_m);
  return tour_m;
}

std::vector<Eigen::Vector2d> mapping_tour(const world::World& world) {
  const planning::FreeSpace space(planning::grid_of(pipeline::drawing_of(world)));
  std::vector<Eigen::Vector2d> tour_m = world.tour_m;
  drive_to(space, *space.frame().cell_of(world.tour_m.front()), tour_m);
  const std::vector<Eigen::Vector2d> rooms_m = tour_of_everything(world);
  tour_m.insert(tour_m.end(), rooms_m.begin(), rooms_m.end());
  return tour_m;
}

geometry::Pose2 MappedFloor::T_world_map() const {
  return T_world_stop.front() * geometry::inverse(stored->trajectory.stops.front().T_map_robot);
}

geometry::Pose2 MappedFloor::T_world_map_at(const Eigen::Vector2d& point_m) const {
  const auto nearer = [&](const geometry::Pose2& a, const geometry::Pose2& b) {
    return (a.position_m() - point_m).squaredNorm() < (b.position_m() - point_m).squaredNorm();
  };
  const auto nearest = std::min_element(T_world_stop.begin(), T_world_stop.end(), nearer);
  const auto stop = static_cast<std::size_t>(nearest - T_world_stop.begin());
  return *nearest * geometry::inverse(stored->trajectory.stops[stop].T_map_robot);
}

MappedFloor map_floor(std::string_view name, const pipeline::Config& config, Wheels wheels,
                      std::uint64_t seed) {
  const double begin_s = support::monotonic_s();
  MappedFloor floor;
  floor.world = navigation_floor(name);
  world::World toured = floor.world;
  toured.tour_m = mapping_tour(floor.world);
  for (std::size_t i = 1; i < toured.tour_m.size(); ++i) {
    floor.tour_m += (toured.tour_m[i] - toured.tour_m[i - 1]).norm();
  }
  simulation::SimulationOptions options;
  options.seed = seed;
  options.odometry = drift_of(wheels, seed);
  options.T_robot_laser = config.local_mapper.T_robot_laser;
  const simulation::SimulatedLog log = simulation::simulate_log(toured, options);
  pipeline::MappingRun mapping(config, "robot");
  for (const scan::Scan& scan : log.scans) mapping.add(scan);
  const storage::MapDocument document = mapping.finish();
  for (const topomap::LocalMap& map : document.local_maps) {
    floor.T_world_stop.push_back(log.T_world_robot[map.sequence]);
  }
  floor.stored = pipeline::stored_map(document);
  planning::FreeSpace space(
      planning::grid_from_scans(document.local_maps, document.trajectory.stops));
  planning::ZoneMap zones =
      planning::zones_of_rooms(space, planning::passages_of(document.global_map));
  floor.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(zones));
  floor.seconds = support::monotonic_s() - begin_s;
  return floor;
}

}  // namespace topogeo::bench
