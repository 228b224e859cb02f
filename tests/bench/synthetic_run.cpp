#include "synthetic_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <span>

#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/scan/carmen_log_writer.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/storage/tum.hpp"
#include "topogeo/topomap/trajectory.hpp"

#include "localization/hand_held.hpp"

namespace topogeo::bench {
namespace {

constexpr double kDegree_rad = std::numbers::pi / 180.0;
constexpr double kEarlier_m = 15.0;  // driven since, for a place to count as seen before

std::vector<topomap::StampedPose> truth_of(const simulation::SimulatedLog& log) {
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
  }
  return truth;
}

// Stops with their true poses and the true path length to each.
struct Stops {
  std::vector<geometry::Pose2> T_world_robot;
  std::vector<double> path_m;
};

Stops stops_of(const storage::MapDocument& document, const simulation::SimulatedLog& log) {
  std::vector<double> path_m{0.0};
  for (std::size_t i = 1; i < log.scans.size(); ++i) {
    path_m.push_back(
        path_m.back() +
        (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm());
  }
  Stops stops;
  for (const topomap::LocalMap& map : document.local_maps) {
    stops.T_world_robot.push_back(log.T_world_robot[map.sequence]);
    stops.path_m.push_back(path_m[map.sequence]);
  }
  return stops;
}

double rms_from_start(std::span<const topomap::StampedPose> corrected,
                      const simulation::SimulatedLog& log) {
  double sum2 = 0.0;
  for (const topomap::StampedPose& pose : corrected) {
    const geometry::Pose2 truth =
        geometry::between(log.T_world_robot.front(), log.T_world_robot[pose.sequence]);
    const geometry::Pose2 estimate = geometry::between(corrected.front().pose, pose.pose);
    sum2 += (truth.position_m() - estimate.position_m()).squaredNorm();
  }
  return std::sqrt(sum2 / static_cast<double>(corrected.size()));
}

void compare_steps(const storage::MapDocument& document, const Stops& stops,
                   SyntheticResult& result) {
  double sum_m2 = 0.0;
  double sum_rad2 = 0.0;
  double path_m = 0.0;
  double odometry_path_m = 0.0;
  double true_path_m = 0.0;
  for (std::size_t i = 1; i < stops.path_m.size(); ++i) {
    const geometry::Pose2 step = geometry::between(document.trajectory.stops[i - 1].T_map_robot,
                                                   document.trajectory.stops[i].T_map_robot);
    const geometry::Pose2 truth =
        geometry::between(stops.T_world_robot[i - 1], stops.T_world_robot[i]);
    const Eigen::Vector3d off = geometry::difference(step, truth);
    sum_m2 += off.head<2>().squaredNorm();
    sum_rad2 += off.z() * off.z();
    path_m += step.position_m().norm();
    odometry_path_m += geometry::between(document.local_maps[i - 1].T_odom_robot,
                                         document.local_maps[i].T_odom_robot)
                           .position_m()
                           .norm();
    true_path_m += truth.position_m().norm();
  }
  const auto steps = static_cast<double>(stops.path_m.size() - 1);
  result.local_m = std::sqrt(sum_m2 / steps);
  result.local_rad = std::sqrt(sum_rad2 / steps);
  result.scale = path_m / true_path_m - 1.0;
  result.odometry_scale = odometry_path_m / true_path_m - 1.0;
}

bool seen_before(const Stops& stops, std::size_t stop) {
  constexpr double kNear_m = 1.5;
  for (std::size_t i = 0; i < stop && stops.path_m[stop] - stops.path_m[i] >= kEarlier_m; ++i) {
    const Eigen::Vector2d apart_m =
        stops.T_world_robot[i].position_m() - stops.T_world_robot[stop].position_m();
    if (apart_m.norm() <= kNear_m) return true;
  }
  return false;
}

void count_loops(const Stops& stops, const std::vector<bool>& closed, SyntheticResult& result) {
  constexpr double kShortest_m = 3.0;
  constexpr double kPiece_m = 10.0;
  const std::size_t n = stops.path_m.size();
  const auto any_closed = [&](std::size_t from, std::size_t to) {
    for (std::size_t i = from; i < to; ++i) {
      if (closed[i]) return true;
    }
    return false;
  };
  for (std::size_t begin = 0; begin < n;) {
    if (!seen_before(stops, begin)) {
      ++begin;
      continue;
    }
    std::size_t end = begin + 1;
    while (end < n && seen_before(stops, end)) ++end;
    if (stops.path_m[end - 1] - stops.path_m[begin] >= kShortest_m) {
      ++result.loops;
      result.loops_closed += any_closed(begin, end) ? 1 : 0;
      for (std::size_t from = begin; from < end;) {
        std::size_t to = from + 1;
        while (to < end && stops.path_m[to] - stops.path_m[from] < kPiece_m) ++to;
        if (stops.path_m[to - 1] - stops.path_m[from] >= kShortest_m) {
          ++result.pieces;
          result.pieces_closed += any_closed(from, to) ? 1 : 0;
        }
        from = to;
      }
    }
    begin = end;
  }
}

void judge_loops(const storage::MapDocument& document, const Stops& stops,
                 SyntheticResult& result) {
  constexpr double kWrong_m = 0.5;
  constexpr double kWrong_rad = 10.0 * kDegree_rad;
  std::vector<bool> closed(stops.path_m.size(), false);
  for (const topomap::LoopClosure& loop : document.loop_closures) {
    const geometry::Pose2 truth =
        geometry::between(stops.T_world_robot[loop.earlier_id], stops.T_world_robot[loop.later_id]);
    const Eigen::Vector3d off = geometry::difference(loop.T_earlier_later, truth);
    const double off_m = off.head<2>().norm();
    const double off_rad = std::fabs(off.z());
    ++result.closures;
    if (off_m > kWrong_m || off_rad > kWrong_rad) {
      result.false_loops.push_back(
          {loop.earlier_id, loop.later_id, off_m, off_rad, truth.position_m().norm()});
    } else if (stops.path_m[loop.later_id] - stops.path_m[loop.earlier_id] >= kEarlier_m) {
      closed[loop.later_id] = true;
    }
  }
  count_loops(stops, closed, result);
}

}  // namespace

const std::vector<SyntheticFloor>& synthetic_floors() {
  static const std::vector<SyntheticFloor> kFloors{
      {"cyclic floor", simulation::cyclic_floor},
      {"corridor there and back", simulation::corridor_there_and_back},
      {"two loops", simulation::two_loops},
      {"bare corridor", simulation::bare_corridor},
      {"symmetric building", simulation::symmetric_building},
      {"long corridors", simulation::long_corridors, true}};
  return kFloors;
}

simulation::SimulatedLog synthetic_drive(const world::World& world, std::uint64_t seed) {
  simulation::SimulationOptions options;
  options.seed = seed;
  options.scan_step_m = 0.35;
  options.scan_step_rad = 10.0 * kDegree_rad;
  options.odometry = simulation::b21_odometry(seed);
  return simulation::simulate_log(world, options);
}

simulation::SimulatedLog hand_held_drive(const world::World& world, std::uint64_t seed) {
  namespace test = localization::test;
  return test::follow(test::hand_held_drive(world, test::hand_held_options(seed))).log;
}

SyntheticResult run_synthetic(const simulation::SimulatedLog& log, const pipeline::Config& config,
                              storage::MapDocument* document) {
  pipeline::MappingRun run(config, "robot");
  for (const scan::Scan& scan : log.scans) run.add(scan);
  storage::MapDocument map = run.finish();
  const Stops stops = stops_of(map, log);
  SyntheticResult result;
  result.scans = log.scans.size();
  result.stops = map.local_maps.size();
  result.path_m = stops.path_m.back();
  const auto truth = truth_of(log);
  const auto corrected = topomap::expand_trajectory(map.trajectory, map.local_maps);
  const pipeline::TrajectoryError error = pipeline::trajectory_error(corrected, truth);
  result.rms_m = error.rms_m;
  result.largest_m = error.largest_m;
  result.heading_rad = error.heading_rad;
  result.odometry_rms_m =
      pipeline::trajectory_error(topomap::expand_odometry(map.local_maps), truth).rms_m;
  result.rms_from_start_m = rms_from_start(corrected, log);
  compare_steps(map, stops, result);
  judge_loops(map, stops, result);
  for (const support::StageTime& stage : run.stages()) result.cpu_s += stage.cpu_s;
  if (document != nullptr) *document = std::move(map);
  return result;
}

void save_log(const simulation::SimulatedLog& log, const std::filesystem::path& folder,
              const std::string& name) {
  scan::CarmenLogWriter writer(folder / (name + ".clf.gz"));
  for (const scan::Scan& scan : log.scans) writer.write(scan);
  writer.close();
  storage::write_trajectory_tum(folder / (name + ".tum"), truth_of(log));
}

}  // namespace topogeo::bench
