#include "reproduce/shared_runs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "topogeo/experiments/thesis_experiments.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/format.hpp"
#include "topogeo/thesis/thesis_mode.hpp"
#include "topogeo/topomap/global_map_builder.hpp"

#include "reproduce/worlds.hpp"

namespace topogeo::reproduce {

using geometry::Pose2;

namespace {

struct DriveSetup {
  const char* name;
  const char* world;
  bool loop;
  double stop_distance_m;
  double longest_m;  ///< of the path; the rest is not driven
  std::size_t most_stops;
  double range_m;   ///< of diagrams and maps
  double recent_m;  ///< stops within this much path are recent; older ones close loops
};

constexpr double kThesisRange_m = 4.0;
constexpr double kWholePath_m = std::numeric_limits<double>::infinity();
constexpr std::size_t kAllStops = std::numeric_limits<std::size_t>::max();
constexpr double kStopTurn_rad = 2.8;  // nearly a half turn on the spot is a stop of its own

constexpr DriveSetup kSetups[] = {
    {"corridor", "experiment_1", false, 1.3, kWholePath_m, kAllStops, 4.0, 6.0},
    {"corridor, 10 m", "experiment_1", false, 1.3, kWholePath_m, kAllStops, 10.0, 6.0},
    {"positions", "experiment_1", false, 2.42, 26.0, 11, 4.0, 6.0},
    {"positions, 10 m", "experiment_1", false, 2.42, 26.0, 11, 10.0, 6.0},
    {"turn", "experiment_1", false, 0.66, kWholePath_m, 46, 4.0, 1.5},
    {"loop", "experiment_2", true, 1.5, kWholePath_m, kAllStops, 4.0, 6.0},
    {"loop, 10 m", "experiment_2", true, 1.5, kWholePath_m, kAllStops, 10.0, 6.0},
    {"door", "door_opens", false, 1.3, kWholePath_m, kAllStops, 4.0, 6.0},
    {"door, 10 m", "door_opens", false, 1.3, kWholePath_m, kAllStops, 10.0, 6.0},
    {"apart", "experiment_1", false, 9.0, 28.0, kAllStops, 3.0, 6.0},
};

const DriveSetup& setup_named(const std::string& name) {
  for (const DriveSetup& setup : kSetups) {
    if (name == setup.name) return setup;
  }
  throw std::invalid_argument("no drive " + name);
}

pipeline::LocalMapperConfig mapper_config(const DriveSetup& setup) {
  const bool thesis = setup.range_m <= kThesisRange_m;
  pipeline::LocalMapperConfig config =
      thesis ? thesis_preset().local_mapper : pipeline::LocalMapperConfig{};
  config.stop_distance_m = setup.stop_distance_m;
  config.stop_turn_rad = kStopTurn_rad;
  config.voronoi.range_limit_m = setup.range_m;
  // With a small field of view, scan points are matched only inside the diagram's view.
  if (thesis && !setup.loop) config.local_map.points_range_m = setup.range_m;
  return config;
}

/// Adds the stop of the last scan. The mapper makes additional stops where maps would not overlap;
/// `apart_m`: stops closer than this are left out.
void add_stop(Drive& drive, topomap::LocalMap map, const Pose2& T_world_robot, double path_m,
              double apart_m) {
  if (!drive.stops.empty() && path_m - drive.path_m.back() < apart_m) return;
  if (apart_m > 0.0) map.track.clear();
  if (drive.stops.empty()) drive.T_world_first = T_world_robot;
  map.id = static_cast<std::uint32_t>(drive.stops.size());
  drive.truth.push_back(geometry::between(drive.T_world_first, T_world_robot));
  const Pose2 T_odom_first =
      drive.stops.empty() ? map.T_odom_robot : drive.stops.front()->T_odom_robot;
  drive.odometry.push_back(geometry::between(T_odom_first, map.T_odom_robot));
  drive.path_m.push_back(path_m);
  drive.stops.push_back(std::make_shared<const topomap::LocalMap>(std::move(map)));
}

Drive make_drive(const DriveSetup& setup, std::uint64_t seed = 1) {
  Drive drive;
  drive.range_m = setup.range_m;
  drive.world = world_named(setup.world);
  // The published drive ends at position 62; this one continues to its start.
  if (setup.loop) drive.world.tour_m.insert(drive.world.tour_m.end(), {{-0.2, 7.0}, {0.0, 3.0}});
  const simulation::SimulatedLog log =
      simulation::simulate_log(drive.world, setup.loop ? simulation::thesis_experiment_2(seed)
                                                       : simulation::thesis_experiment_1(seed));
  pipeline::LocalMapper mapper(mapper_config(setup), "robot");
  double path_m = 0.0;
  const double apart_m = std::string_view(setup.name) == "apart" ? setup.stop_distance_m : 0.0;
  const double start_s = support::monotonic_s();
  std::size_t last = 0;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    if (i > 0) {
      path_m += (log.T_world_robot[i].position_m() - log.T_world_robot[i - 1].position_m()).norm();
    }
    if (path_m > setup.longest_m || drive.stops.size() == setup.most_stops) break;
    last = i;
    if (auto map = mapper.add(log.scans[i])) {
      add_stop(drive, std::move(*map), log.T_world_robot[i], path_m, apart_m);
    }
  }
  if (drive.stops.size() < setup.most_stops && setup.longest_m == kWholePath_m) {
    if (auto map = mapper.finish()) {
      add_stop(drive, std::move(*map), log.T_world_robot[last], path_m, apart_m);
    }
  }
  drive.perception_ms =
      1e3 * (support::monotonic_s() - start_s) / static_cast<double>(drive.stops.size());
  return drive;
}

/// The parameters of the Thesis; matches of scan points keep the search of the product around them.
localization::ThesisSlamConfig thesis_config(const CorrectionKind& kind, const DriveSetup& setup) {
  localization::ThesisSlamConfig config = localization::thesis_config(thesis_preset().localizer);
  const bool preset = kind.evidence == localization::MatchEvidence::kFitness;
  if (!preset) {
    config = {};
    config.mode = localization::SlamAlgorithm::kThesis;
    config.genetic.individuals = 100;
    config.genetic.generations = 50;
  }
  if (!kind.calibrated) {
    config.odometry = {};
    // The odometry of a straight drive errs by degrees, not by tens of them.
    if (!setup.loop) config.odometry.heading_rad2_per_m = 0.01;
  }
  if (!kind.kept) config.thesis.kept_solutions = 0;
  config.fitness_form = kind.form;
  config.evidence = kind.evidence;
  if (!kind.backward) config.revisit_matches = 0;
  config.recent_way_m = setup.recent_m;
  return config;
}

void keep_backward(Correction& correction, std::size_t stop, const std::vector<Pose2>& before) {
  const auto& closing = correction.slam->cycles().last_closing();
  if (!closing) return;
  correction.backward.push_back(
      {stop, closing->problem.first_id, closing->found.paths, closing->problem, before});
}

Correction correct(const Drive& drive, const CorrectionKind& kind, const DriveSetup& setup) {
  Correction correction;
  correction.config = thesis_config(kind, setup);
  correction.pool = std::make_unique<localization::InProcessPool>();
  for (const auto& stop : drive.stops) correction.pool->add_map(stop);
  correction.slam = std::make_unique<localization::ThesisSlam>(correction.config, *correction.pool);
  const double start_s = support::monotonic_s();
  for (std::size_t k = 0; k < drive.stops.size(); ++k) {
    const bool moved = correction.slam->add(drive.stops[k]);
    correction.closed.push_back(moved);
    correction.overlaps.push_back(correction.map().stop(k).overlaps);
    const std::vector<Pose2> before =
        correction.poses_after.empty() ? std::vector<Pose2>{} : correction.poses_after.back();
    if (moved) keep_backward(correction, k, before);
    correction.poses_after.push_back(correction.slam->poses());
    correction.kept.emplace_back();
    for (const localization::CycleSolution& solution : correction.slam->kept().all()) {
      correction.kept.back().push_back(solution.T_map_stop);
    }
  }
  correction.slam->finish();
  correction.poses_after.back() = correction.slam->poses();
  correction.wall_s = support::monotonic_s() - start_s;
  return correction;
}

}  // namespace

std::string matcher_text(const localization::LocalizerConfig& config) {
  using localization::FitnessForm;
  using localization::MatchEvidence;
  const char* form = config.fitness_form == FitnessForm::kPrinted       ? "printed form"
                     : config.fitness_form == FitnessForm::kTopological ? "topological form"
                     : config.fitness_form == FitnessForm::kCombined    ? "combined form"
                                                                        : "weighted form";
  const char* evidence = config.evidence == MatchEvidence::kFitness ? "no gate, no scan points"
                         : config.evidence == MatchEvidence::kScan  ? "scan points and gate"
                                                                    : "walls of branches and gate";
  return fmt::format("{}, {}", form, evidence);
}

Means means_of(const Drive& drive) {
  return {"no matching", drive.range_m, 1};
}

Means means_of(const Drive& drive, const Correction& correction) {
  return {matcher_text(correction.config), drive.range_m, 1};
}

Drive loop_drive(std::uint64_t seed) {
  return make_drive(setup_named("loop"), seed);
}

Correction correct_loop(const Drive& drive, const CorrectionKind& kind) {
  return correct(drive, kind, setup_named("loop"));
}

std::vector<topomap::LocalMap> Drive::maps() const {
  std::vector<topomap::LocalMap> all;
  all.reserve(stops.size());
  for (const auto& stop : stops) all.push_back(*stop);
  return all;
}

const Drive& SharedRuns::drive(const std::string& name) {
  const auto at = drives_.find(name);
  if (at != drives_.end()) return at->second;
  return drives_.emplace(name, make_drive(setup_named(name))).first->second;
}

const Correction& SharedRuns::correction(const std::string& name, const CorrectionKind& kind) {
  const auto at = corrections_.find({name, kind});
  if (at != corrections_.end()) return at->second;
  return corrections_.emplace(std::pair{name, kind}, correct(drive(name), kind, setup_named(name)))
      .first->second;
}

PoseErrors pose_errors(const std::vector<Pose2>& poses, const std::vector<Pose2>& truth) {
  PoseErrors errors;
  const std::size_t count = std::min(poses.size(), truth.size());
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d off = geometry::difference(poses[i], truth[i]);
    errors.last_m = off.head<2>().norm();
    errors.last_rad = std::fabs(off.z());
    errors.mean_m += errors.last_m / static_cast<double>(count);
    errors.largest_m = std::max(errors.largest_m, errors.last_m);
  }
  return errors;
}

topomap::GlobalMap fused(const Drive& drive, const std::vector<Pose2>& poses, std::size_t count,
                         topomap::FusionRule rule) {
  topomap::GlobalMapConfig config;
  config.fusion = rule;
  topomap::GlobalMapBuilder builder(config);
  for (std::size_t i = 0; i < std::min(count, poses.size()); ++i) {
    builder.integrate(*drive.stops[i], poses[i]);
  }
  return builder.snapshot(1);
}

}  // namespace topogeo::reproduce
