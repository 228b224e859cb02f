#include "exploration_run.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/world_grid.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/planning/hybrid_planner.hpp"
#include "topogeo/planning/zones.hpp"
#include "topogeo/session/slam_session.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/support/seed.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "closed_loop.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;
using planning::Cell;

/// The truth: where a robot can get to from its start, and the area that its body covers there.
class Reach {
 public:
  Reach(const world::World& world, std::uint64_t seed)
      : space_(planning::grid_of(pipeline::drawing_of(world))), zones_(zones_by_width(space_)) {
    const planning::ZoneMap parts = planning::drawn_zones(space_, {});
    const auto origin = space_.frame().cell_of(world.tour_m.front());
    if (!origin || !space_.passable(*origin)) throw std::runtime_error(world.name + ": tour");
    const planning::ZoneId part = parts.zone_of_cell[space_.frame().index(*origin)];
    for (std::size_t i = 0; i < space_.frame().size(); ++i) {
      if (parts.zone_of_cell[i] == part) cells_.push_back(i);
    }
    cover();
    draw_start(seed);
  }

  [[nodiscard]] const Pose2& T_world_start() const { return T_world_start_; }

  /// Share of the coverable area that a map knows.
  [[nodiscard]] double seen(const planning::OccupancyGrid& grid, const Pose2& T_map_world) const {
    std::size_t known = 0;
    for (const std::size_t index : covered_) {
      const Eigen::Vector2d at_m = space_.frame().center_m(space_.frame().cell_at(index));
      const auto cell = grid.frame().cell_of(T_map_world * at_m);
      if (cell && grid.at(*cell) != planning::CellState::kUnknown) ++known;
    }
    return static_cast<double>(known) / static_cast<double>(covered_.size());
  }

  void count_rooms(const std::vector<Pose2>& T_world_robot, ExplorationResult& result) const {
    std::vector<std::size_t> cells(zones_.zones.size(), 0);
    for (const std::size_t index : cells_) ++cells[zones_.zone_of_cell[index]];
    std::vector<bool> entered(zones_.zones.size(), false);
    for (const Pose2& pose : T_world_robot) {
      const auto cell = space_.frame().cell_of(pose.position_m());
      const auto zone = cell ? zones_.zone_of_cell[space_.frame().index(*cell)] : planning::kNoZone;
      if (zone != planning::kNoZone) entered[zone] = true;
    }
    constexpr double kRoom_m2 = 2.0;
    const double cell_m2 = space_.frame().resolution_m * space_.frame().resolution_m;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (static_cast<double>(cells[i]) * cell_m2 < kRoom_m2) continue;
      ++result.rooms;
      if (entered[i]) ++result.entered;
    }
  }

 private:
  void cover() {
    const planning::GridFrame& frame = space_.frame();
    const double reach = devices::kB21Radius_m / frame.resolution_m;
    const auto around = static_cast<std::int32_t>(reach);
    std::vector<bool> covered(frame.size(), false);
    for (const std::size_t index : cells_) {
      const Cell middle = frame.cell_at(index);
      for (std::int32_t y = -around; y <= around; ++y) {
        for (std::int32_t x = -around; x <= around; ++x) {
          const Cell cell{middle.column + x, middle.row + y};
          if (std::hypot(x, y) <= reach && frame.contains(cell) &&
              space_.grid().at(cell) == planning::CellState::kFree) {
            covered[frame.index(cell)] = true;
          }
        }
      }
    }
    for (std::size_t i = 0; i < covered.size(); ++i) {
      if (covered[i]) covered_.push_back(i);
    }
  }

  void draw_start(std::uint64_t seed) {
    constexpr double kRoom_m = 0.5;
    support::Random random(support::derive_seed(seed, "start of an exploration", {}));
    while (true) {
      const Cell cell = space_.frame().cell_at(cells_[random.below(cells_.size())]);
      if (space_.clearance_m(cell) < kRoom_m) continue;
      const Eigen::Vector2d at_m = space_.frame().center_m(cell);
      T_world_start_ = {at_m.x(), at_m.y(), random.uniform(-std::numbers::pi, std::numbers::pi)};
      return;
    }
  }

  planning::FreeSpace space_;
  planning::ZoneMap zones_;
  std::vector<std::size_t> cells_;    // that its middle can reach
  std::vector<std::size_t> covered_;  // that its body can cover
  Pose2 T_world_start_;
};

/// The map so far, fused as the map store does it.
class GrowingMap {
 public:
  explicit GrowingMap(const topomap::GlobalMapConfig& config) : builder_(config) {}

  void add(const std::vector<std::shared_ptr<const topomap::LocalMap>>& maps) {
    while (maps_.size() < maps.size()) maps_.push_back(*maps[maps_.size()]);
  }

  /// Takes over the poses; rebuilds the graph when one has moved noticeably.
  navigation::ExploredMap update(const topomap::Trajectory& trajectory) {
    if (moved(trajectory.stops)) {
      builder_.rebuild(maps_, trajectory.stops);
      used_.clear();
      for (const topomap::StopPose& stop : trajectory.stops) used_.push_back(stop.T_map_robot);
    }
    for (std::size_t i = used_.size(); i < maps_.size(); ++i) {
      builder_.integrate(maps_[i], trajectory.stops[i].T_map_robot);
      used_.push_back(trajectory.stops[i].T_map_robot);
    }
    navigation::ExploredMap map;
    map.version = ++version_;
    map.graph = std::make_shared<const topomap::GlobalMap>(builder_.snapshot(version_));
    planning::FreeSpace space(planning::grid_from_scans(maps_, trajectory.stops));
    const std::vector<planning::Passage> passages = planning::passages_of(*map.graph);
    planning::ZoneMap zones = passages.empty() ? planning::zones_by_width(space)
                                               : planning::zones_of_rooms(space, passages);
    map.map = std::make_shared<const planning::HybridMap>(std::move(space), std::move(zones));
    for (const topomap::StopPose& stop : trajectory.stops) {
      map.T_map_stops.push_back(stop.T_map_robot);
    }
    return map;
  }

  [[nodiscard]] std::size_t size() const { return maps_.size(); }

 private:
  [[nodiscard]] bool moved(std::span<const topomap::StopPose> stops) const {
    constexpr double kMoved_m = 0.05;
    constexpr double kTurned_rad = 0.0175;
    for (std::size_t i = 0; i < used_.size(); ++i) {
      const Pose2 step = geometry::between(used_[i], stops[i].T_map_robot);
      if (step.position_m().norm() > kMoved_m || std::fabs(step.theta_rad) > kTurned_rad) {
        return true;
      }
    }
    return false;
  }

  topomap::GlobalMapBuilder builder_;
  std::vector<Pose2> used_;  // pose at which each map was fused
  std::vector<topomap::LocalMap> maps_;
  std::uint64_t version_ = 0;
};

ClosedLoopConfig loop_config(const ExplorationConfig& config, const Pose2& T_world_start,
                             std::uint64_t seed) {
  ClosedLoopConfig loop;
  loop.system = config.system;
  loop.navigator = config.navigator;
  loop.mapping = true;
  loop.planner.goal_snap_m = 0.3;  // the goal's cell may have become forbidden since
  loop.robot = b21_robot(T_world_start, config.system.local_mapper.T_robot_laser, config.wheels,
                         config.slip_per_m, seed);
  return loop;
}

double scripted_m(world::World world, const Pose2& T_world_start) {
  world.tour_m = {T_world_start.position_m()};
  const std::vector<Eigen::Vector2d> tour_m = tour_of_everything(world);
  double length_m = 0.0;
  for (std::size_t i = 1; i < tour_m.size(); ++i) length_m += (tour_m[i] - tour_m[i - 1]).norm();
  return length_m;
}

double rms_m(const topomap::Trajectory& trajectory, const std::vector<Pose2>& T_world_stop) {
  double sum_m2 = 0.0;
  for (std::size_t i = 0; i < T_world_stop.size(); ++i) {
    const Pose2 T_map_true = geometry::between(T_world_stop.front(), T_world_stop[i]);
    sum_m2 +=
        (T_map_true.position_m() - trajectory.stops[i].T_map_robot.position_m()).squaredNorm();
  }
  return std::sqrt(sum_m2 / static_cast<double>(T_world_stop.size()));
}

}  // namespace

ExplorationResult explore(std::string_view floor, const ExplorationConfig& config,
                          std::uint64_t seed, ExplorationRecord* record) {
  const world::World world = navigation_floor(floor);
  const Reach reach(world, seed);
  localization::InProcessPool pool;
  const auto slam = localization::make_slam(config.system.localizer, pool);
  ClosedLoop loop(world, loop_config(config, reach.T_world_start(), seed), *slam);
  navigation::ExplorationTour tour(config.tour);
  GrowingMap growing(config.system.global_map);
  navigation::ExploredMap map;
  std::vector<Pose2> T_world_stop;
  std::vector<Pose2> T_world_robot;
  std::string said;
  constexpr std::uint64_t kMapTicks = 200;
  constexpr std::uint64_t kTourTicks = 20;
  const double start_s = loop.time_s();
  for (std::uint64_t tick = 1; !tour.done() && loop.time_s() - start_s < config.longest_s; ++tick) {
    loop.tick();
    if (loop.made_stop()) T_world_stop.push_back(loop.robot().T_world_robot());
    if (tick % kMapTicks == 0 && loop.local_maps().size() > growing.size()) {
      growing.add(loop.local_maps());
      map = growing.update(slam->trajectory());
      loop.set_map(map.map, map.version);
      tour.set_map(map);
    }
    if (tick % kTourTicks != 0) continue;
    T_world_robot.push_back(loop.robot().T_world_robot());
    const auto now_ns = static_cast<std::int64_t>(1e9 * loop.time_s());
    navigation::NavigatorStatus status = loop.navigator().status();
    if (!status.T_map_robot && loop.pose() && status.goal_id == 0) {
      status.T_map_robot = loop.pose()->T_map_robot;
    }
    const auto goal = tour.step(status, now_ns);
    if (record != nullptr && status.message != said) {
      said = status.message;
      record->log.push_back(fmt::format("{:7.1f} s            {}: {}", loop.time_s(),
                                        navigation::describe(status.state), said));
    }
    if (!goal) continue;
    loop.set_goal(
        {{goal->goal_id, false}, goal->T_map_goal.position_m(), goal->T_map_goal.theta_rad});
    if (record != nullptr) {
      record->log.push_back(fmt::format("{:7.1f} s {:6.1f} m  ({:.2f}, {:.2f}) {}", loop.time_s(),
                                        loop.robot().path_m(), goal->T_map_goal.x_m,
                                        goal->T_map_goal.y_m, tour.message()));
    }
  }
  ExplorationResult result;
  result.done = tour.done();
  const Pose2 T_map_world = geometry::inverse(T_world_stop.front());
  result.seen = map.map ? reach.seen(map.map->space().grid(), T_map_world) : 0.0;
  reach.count_rooms(T_world_robot, result);
  result.collisions = loop.robot().collisions();
  result.path_m = loop.robot().path_m();
  result.scripted_m = scripted_m(world, reach.T_world_start());
  result.time_s = loop.time_s() - start_s;
  result.targets = tour.targets();
  result.given_up = tour.given_up();
  result.stops = T_world_stop.size();
  result.pose_error_m = rms_m(slam->trajectory(), T_world_stop);
  result.end = tour.message() + "; " +
               std::string(navigation::describe(loop.navigator().status().state)) + " " +
               loop.navigator().status().message;
  if (record != nullptr) {
    record->map = map.map;
    for (const Pose2& pose : T_world_robot) {
      record->path_m.push_back(T_map_world * pose.position_m());
    }
  }
  return result;
}

}  // namespace topogeo::bench
