#include "patrol_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/planning/grid_sources.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/session/mapping_session.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/random.hpp"
#include "topogeo/world/world.hpp"

#include "map_store/map_archive.hpp"
#include "map_store/map_input.hpp"
#include "process_memory.hpp"

namespace topogeo::bench {
namespace {

using geometry::Pose2;

constexpr std::int64_t kYear_ns = 365LL * 24 * 3'600'000'000'000;

struct Box {
  Eigen::Vector2d low_m;
  Eigen::Vector2d high_m;
};

/// Places of the cupboard in turn, at walls of the corridors.
const std::vector<Box>& cupboard_places() {
  static const std::vector<Box> places = {
      {{7.4, 0.06}, {8.3, 0.5}},     {{29.5, 9.4}, {29.94, 10.3}}, {{14.0, 0.06}, {14.9, 0.5}},
      {{20.4, 19.5}, {21.3, 19.94}}, {{20.0, 0.06}, {20.9, 0.5}},  {{0.06, 7.0}, {0.5, 7.9}}};
  return places;
}

void add_box(world::World& world, const Box& box) {
  const Eigen::Vector2d a = box.low_m;
  const Eigen::Vector2d b(box.high_m.x(), box.low_m.y());
  const Eigen::Vector2d c = box.high_m;
  const Eigen::Vector2d d(box.low_m.x(), box.high_m.y());
  for (const auto& [from, to] :
       {std::pair(a, b), std::pair(b, c), std::pair(c, d), std::pair(d, a)}) {
    world.segments.push_back({from, to});
  }
}

std::size_t place_of_cupboard(const PatrolOptions& options, std::size_t drive) {
  return drive / options.drives_per_move % cupboard_places().size();
}

/// The floor during a drive: each of nine doors is open or shut.
world::World floor_of(const PatrolOptions& options, std::size_t drive) {
  world::World world = world::load_world(std::filesystem::path(TOPOGEO_SOURCE_DIR) /
                                         "share/worlds/floor.world.yaml");
  world.tour_m = {{1.3, 1.2},   {15.0, 1.15}, {28.9, 1.2}, {28.9, 9.0}, {28.8, 18.7},
                  {15.0, 18.8}, {1.3, 18.8},  {1.3, 9.6},  {1.3, 1.2},  {11.0, 1.15}};
  support::Random random(1000 + drive);
  const std::vector<world::Segment> doors = {
      {{3.7, 2.2}, {4.7, 2.2}},     {{8.6, 2.2}, {9.6, 2.2}},   {{11.4, 2.2}, {12.4, 2.2}},
      {{18.2, 2.2}, {19.2, 2.2}},   {{23.5, 0.0}, {24.5, 0.0}}, {{9.3, 17.6}, {10.3, 17.6}},
      {{21.2, 17.6}, {22.2, 17.6}}, {{8.0, 20.0}, {9.0, 20.0}}, {{0.0, 9.3}, {0.0, 10.3}}};
  for (const world::Segment& door : doors) {
    if (random.below(2) == 0) world.segments.push_back(door);
  }
  add_box(world, cupboard_places()[place_of_cupboard(options, drive)]);
  return world;
}

simulation::SimulatedLog drive_of(const PatrolOptions& options, std::size_t drive) {
  simulation::SimulationOptions simulation;
  simulation.seed = 1 + drive;
  simulation.scan_step_m = 0.33;
  simulation.odometry = simulation::b21_odometry(1 + drive);
  simulation.wanderers = options.people;
  simulation.start_stamp_ns = 1'000'000'000 + static_cast<std::int64_t>(drive) * (kYear_ns / 500);
  return simulation::simulate_log(floor_of(options, drive), simulation);
}

/// A map store without DDS, which gets the localizer's messages directly.
class Store {
 public:
  Store(const std::filesystem::path& directory, const pipeline::Config& config)
      : config_(config),
        file_(directory / "map.sqlite"),
        archive_(storage::MapDatabase::open_or_create(file_, "robot", config.localizer.seed),
                 file_) {}

  void add(const topomap::LocalMap& map) {
    archive_.add(map);
    input_.add(map);
    if (archive_.has_batch()) static_cast<void>(archive_.flush());
  }

  void end_of_drive(const localization::MappingSession& session) {
    const topomap::Trajectory trajectory = session.trajectory();
    input_.add(service::to_msg(session.loop_closures(), trajectory.version, "robot", 0, 0,
                               trajectory.numbered_since));
    for (const auto& segment : service::to_segments(trajectory, "robot", 0)) input_.add(segment);
    const auto edges = pipeline::map_edges(session.edges());
    for (std::uint32_t i = 0; i < service::edge_segment_count(edges.size()); ++i) {
      input_.add(service::to_segment(edges, i, trajectory.version, "robot", 0, 0,
                                     trajectory.numbered_since));
    }
    static_cast<void>(archive_.flush());
    archive_.put(input_.local_maps(), input_.newest_trajectory(), input_.usable_closures());
    archive_.put(input_.usable_edges());
    map_ = pipeline::fuse(config_.global_map, input_.local_maps(), input_.newest_trajectory());
    archive_.put(map_);
  }

  /// Whether it has the stops of the localizer under their ids, in memory and in the file.
  [[nodiscard]] bool has_map_of(const localization::MappingSession& session) const {
    const auto& maps = session.maps();
    if (input_.local_maps().size() != maps.size()) return false;
    if (archive_.database().local_map_count() != maps.size()) return false;
    return std::equal(maps.begin(), maps.end(), input_.local_maps().begin(),
                      [](const auto& a, const topomap::LocalMap& b) {
                        return a->stop == b.stop && a->id == b.id &&
                               a->starts_drive == b.starts_drive;
                      });
  }

  [[nodiscard]] std::uintmax_t bytes() const { return storage::database_bytes(file_); }
  [[nodiscard]] const topomap::GlobalMap& map() const { return map_; }
  [[nodiscard]] const std::vector<topomap::LocalMap>& local_maps() const {
    return input_.local_maps();
  }
  [[nodiscard]] topomap::Trajectory trajectory() const { return input_.newest_trajectory(); }

 private:
  const pipeline::Config& config_;
  std::filesystem::path file_;
  map_store::MapArchive archive_;
  map_store::MapInput input_;
  topomap::GlobalMap map_;
};

class Patrol {
 public:
  Patrol(const PatrolOptions& options, const pipeline::Config& config)
      : options_(options),
        config_(config),
        session_(config.localizer, pool_),
        store_(options.directory, config) {}

  PatrolDrive run(std::size_t number) {
    const double cpu_before_s = support::process_cpu_s();
    const simulation::SimulatedLog log = drive_of(options_, number);
    pipeline::LocalMapper mapper(config_.local_mapper, "robot", number);
    PatrolDrive drive;
    drive.drive = number + 1;
    std::uint64_t session = 0;
    const std::size_t added_before = session_.added_stops();
    const auto take = [&](std::optional<topomap::LocalMap> map) {
      if (!map) return;
      if (!T_map_world_) T_map_world_ = geometry::inverse(log.T_world_robot[map->sequence]);
      session = map->stop.session;
      T_map_robot_[map->stop] = *T_map_world_ * log.T_world_robot[map->sequence];
      store_.add(*map);
      session_.add(std::make_shared<const topomap::LocalMap>(std::move(*map)));
      ++drive.stops;
    };
    for (const scan::Scan& scan : log.scans) take(mapper.add(scan));
    take(mapper.finish());
    session_.finish();
    store_.end_of_drive(session_);
    drive.unmapped = drive.stops - (session_.added_stops() - added_before);
    drive.map_stops = session_.maps().size();
    drive.loops = session_.loop_closures().size();
    drive.nodes = store_.map().nodes.size();
    drive.rms_m = rms_m(session);
    drive.map_rms_m = rms_m(std::nullopt);
    drive.file_bytes = store_.bytes();
    drive.memory_mb = memory_now_mb();
    drive.cpu_s = support::process_cpu_s() - cpu_before_s;
    return drive;
  }

  [[nodiscard]] bool same_in_store() const { return store_.has_map_of(session_); }

  void count_cells(PatrolResult& result) const {
    const topomap::Trajectory trajectory = store_.trajectory();
    const planning::OccupancyGrid grid =
        planning::grid_from_scans(store_.local_maps(), trajectory.stops);
    const std::size_t now = place_of_cupboard(options_, options_.drives - 1);
    for (std::size_t i = 0; i < cupboard_places().size(); ++i) {
      const std::size_t cells = occupied(grid, cupboard_places()[i]);
      result.ghost_cells.push_back(cells);
      (i == now ? result.cupboard_cells : result.ghosts) += cells;
    }
  }

 private:
  [[nodiscard]] double rms_m(std::optional<std::uint64_t> session) const {
    double sum = 0.0;
    std::size_t count = 0;
    for (const topomap::StopPose& stop : session_.trajectory().stops) {
      if (session && stop.stop.session != *session) continue;
      sum +=
          (stop.T_map_robot.position_m() - T_map_robot_.at(stop.stop).position_m()).squaredNorm();
      ++count;
    }
    return count == 0 ? 0.0 : std::sqrt(sum / static_cast<double>(count));
  }

  /// Occupied cells of the front of a box, because those at the wall behind it are always occupied.
  [[nodiscard]] std::size_t occupied(const planning::OccupancyGrid& grid, const Box& box) const {
    constexpr double kWall_m = 0.25;
    constexpr double kStep_m = 0.05;
    const Eigen::Vector2d floor_m(30.0, 20.0);
    std::map<std::size_t, bool> cells;
    for (double x = box.low_m.x(); x <= box.high_m.x(); x += kStep_m) {
      for (double y = box.low_m.y(); y <= box.high_m.y(); y += kStep_m) {
        if (std::min({x, y, floor_m.x() - x, floor_m.y() - y}) < kWall_m) continue;
        const auto cell = grid.frame().cell_of(*T_map_world_ * Eigen::Vector2d(x, y));
        if (cell)
          cells[grid.frame().index(*cell)] = grid.at(*cell) == planning::CellState::kOccupied;
      }
    }
    return static_cast<std::size_t>(
        std::ranges::count_if(cells, [](const auto& cell) { return cell.second; }));
  }

  PatrolOptions options_;
  pipeline::Config config_;
  localization::InProcessPool pool_;
  localization::MappingSession session_;
  Store store_;
  std::optional<Pose2> T_map_world_;
  std::map<topomap::StopId, Pose2> T_map_robot_;  // the truth
};

}  // namespace

PatrolResult run_patrol(const PatrolOptions& options, const pipeline::Config& config,
                        const std::function<void(const PatrolDrive&)>& on_drive) {
  std::filesystem::remove_all(options.directory);
  std::filesystem::create_directories(options.directory);
  Patrol patrol(options, config);
  PatrolResult result;
  for (std::size_t i = 0; i < options.drives; ++i) {
    result.drives.push_back(patrol.run(i));
    result.same_in_store &= patrol.same_in_store();
    if (on_drive) on_drive(result.drives.back());
  }
  patrol.count_cells(result);
  return result;
}

}  // namespace topogeo::bench
