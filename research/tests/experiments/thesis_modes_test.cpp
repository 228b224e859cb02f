// The configurations of the thesis's algorithm on the replica of its first experiment: each form of
// the fitness makes a map, and the weighted one stays near the truth without scan points.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "topogeo/experiments/thesis_experiments.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/topomap/trajectory.hpp"
#include "topogeo/world/world.hpp"

namespace topogeo::pipeline {
namespace {

const std::filesystem::path kThesisData = std::filesystem::path(TOPOGEO_SHARE) / "thesis";

struct MappedExperiment {
  storage::MapDocument map;
  double odometry_rms_m = 0.0;
  double rms_m = 0.0;
};

MappedExperiment map_experiment(const std::string& config_name) {
  const simulation::SimulatedLog log =
      simulation::simulate_log(world::load_world(kThesisData / "experiment_1.world.yaml"),
                               simulation::thesis_experiment_1());
  std::vector<topomap::StampedPose> truth;
  MappingRun run(load_config(kThesisData / (config_name + ".config.yaml")).config, "robot");
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
    run.add(log.scans[i]);
  }
  MappedExperiment mapped;
  mapped.map = run.finish();
  const auto error = [&truth](const std::vector<topomap::StampedPose>& poses) {
    return trajectory_error(poses, truth).rms_m;
  };
  mapped.odometry_rms_m = error(topomap::expand_odometry(mapped.map.local_maps));
  mapped.rms_m = error(topomap::expand_trajectory(mapped.map.trajectory, mapped.map.local_maps));
  return mapped;
}

TEST(ThesisModes, EachFormOfTheFitnessMakesAMap) {
  for (const char* name : {"printed", "topological", "topological_weighted", "combined"}) {
    const MappedExperiment mapped = map_experiment(name);
    EXPECT_GT(mapped.map.trajectory.stops.size(), 35U) << name;
    EXPECT_TRUE(std::isfinite(mapped.rms_m)) << name;
    EXPECT_FALSE(mapped.map.global_map.branches.empty()) << name;
    EXPECT_FALSE(mapped.map.global_map.nodes.empty()) << name;
  }
}

TEST(ThesisModes, WeightedBranchesKeepToTheTruth) {
  const MappedExperiment mapped = map_experiment("topological_weighted");
  EXPECT_GT(mapped.odometry_rms_m, 0.4);
  EXPECT_LT(mapped.rms_m, 0.15);
}

TEST(ThesisModes, ScanPointsCloseTheLoops) {
  const MappedExperiment mapped = map_experiment("combined");
  EXPECT_LT(mapped.rms_m, 0.06);
  EXPECT_GT(mapped.map.loop_closures.size(), 5U);
}

}  // namespace
}  // namespace topogeo::pipeline
