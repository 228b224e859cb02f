// Maps by a laser that is carried through a floor, without odometry.
//
//   topogeo_hand_held [--floors N] [--first-seed S] [--motion known|unknown] [--verbose]
//
// Each floor is drawn from a seed (random_floors.hpp: corridors round one block, round two, and
// there and back in one corridor with rooms). The laser sees 12 m and 270 degrees, ten times a
// second, at walking pace (1.2 m/s, 90 degrees/s in turns). The map is that of `topogeo map`, by
// odometry from the scans. A loop counts as closed if places that are seen again have a relative
// error of 0.10 m or less. Prints a row for each sort of floor.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/config.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/pipeline/scan_feed.hpp"
#include "topogeo/pipeline/trajectory_error.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"

#include "localization/hand_held.hpp"

namespace {

using namespace topogeo;

constexpr double kRight_m = 0.10;

struct FloorKind {
  const char* name;
  world::World (*make)(std::uint64_t seed);
};
constexpr std::array<FloorKind, 3> kKinds{
    {{"round one block", simulation::cyclic_floor},
     {"round two blocks", simulation::two_loops},
     {"there and back", simulation::corridor_there_and_back}}};

/// How the laser moves while it measures the beams of a scan.
enum class MotionInScan : std::uint8_t { kNone, kKnownTimes, kUnknownTimes };

simulation::SimulatedLog walk(const world::World& world, std::uint64_t seed, MotionInScan motion) {
  simulation::SimulatedLog ticks =
      simulation::simulate_log(world, localization::test::hand_held_options(seed));
  if (motion == MotionInScan::kNone) {
    return localization::test::every_tenth_of_a_second(std::move(ticks));
  }
  return localization::test::skewed(std::move(ticks), motion == MotionInScan::kKnownTimes);
}

struct HandHeldMap {
  std::size_t scans = 0;
  std::size_t placed = 0;
  std::ptrdiff_t loops = 0;
  std::uint64_t breaks = 0;
  double rms_m = 0.0;
  std::optional<double> loop_m;  ///< none: no place is seen again
};

HandHeldMap map_of(const simulation::SimulatedLog& log) {
  const pipeline::Config config;
  std::size_t next = 0;
  pipeline::ScanFeed feed(
      [&]() -> std::optional<scan::Scan> {
        if (next == log.scans.size()) return std::nullopt;
        return log.scans[next++];
      },
      {config.local_mapper.T_robot_laser, config.local_mapper.local_map.points_range_m});
  pipeline::MappingRun run(config, "robot");
  while (const std::optional<scan::Scan> scan = feed.next()) run.add(*scan);
  const storage::MapDocument document = run.finish();
  std::vector<topomap::StampedPose> truth;
  for (std::size_t i = 0; i < log.scans.size(); ++i) {
    truth.push_back({log.scans[i].sequence, log.scans[i].stamp_ns, log.T_world_robot[i]});
  }
  const auto placed = topomap::expand_trajectory(document.trajectory, document.local_maps);
  const pipeline::TrajectoryError error = pipeline::trajectory_error(placed, truth);
  const auto loop_closures =
      std::ranges::count(document.edges, storage::MapEdge::Kind::kLoop, &storage::MapEdge::kind);
  HandHeldMap outcome{log.scans.size(), placed.size(), loop_closures, feed.laser_counts()->breaks,
                      error.rms_m,      std::nullopt};
  if (error.loop) outcome.loop_m = error.loop->mean_m;
  return outcome;
}

double largest(const std::vector<HandHeldMap>& outcomes) {
  return std::ranges::max_element(outcomes, {}, &HandHeldMap::rms_m)->rms_m;
}

double median(const std::vector<HandHeldMap>& outcomes) {
  std::vector<double> rms_m;
  rms_m.reserve(outcomes.size());
  for (const HandHeldMap& outcome : outcomes) rms_m.push_back(outcome.rms_m);
  std::ranges::nth_element(rms_m, rms_m.begin() + static_cast<std::ptrdiff_t>(rms_m.size() / 2));
  return rms_m[rms_m.size() / 2];
}

void print_row(const char* name, const std::vector<HandHeldMap>& outcomes) {
  const auto right = std::ranges::count_if(
      outcomes, [](const HandHeldMap& outcome) { return outcome.rms_m <= kRight_m; });
  const auto open = std::ranges::count_if(
      outcomes, [](const HandHeldMap& outcome) { return outcome.loop_m.value_or(0.0) > kRight_m; });
  const auto broken = std::ranges::count_if(
      outcomes, [](const HandHeldMap& outcome) { return outcome.breaks > 0; });
  std::printf("| %s | %zu | %td | %td | %td | %.3f | %.3f |\n", name, outcomes.size(), right, open,
              broken, median(outcomes), largest(outcomes));
}

int run(std::uint64_t floors, std::uint64_t first_seed, MotionInScan motion, bool verbose) {
  std::array<std::vector<HandHeldMap>, kKinds.size()> outcomes;
  for (std::uint64_t i = 0; i < floors; ++i) {
    const std::size_t kind = i % kKinds.size();
    const std::uint64_t seed = first_seed + i;
    const HandHeldMap& outcome =
        outcomes.at(kind).emplace_back(map_of(walk(kKinds.at(kind).make(seed), seed, motion)));
    if (!verbose) continue;
    std::printf(
        "%s, seed %llu: %zu of %zu scans, %td loops, %llu breaks, %.3f m rms, %.3f m loop\n",
        kKinds.at(kind).name, static_cast<unsigned long long>(seed), outcome.placed, outcome.scans,
        outcome.loops, static_cast<unsigned long long>(outcome.breaks), outcome.rms_m,
        outcome.loop_m.value_or(0.0));
    std::fflush(stdout);
  }
  std::printf(
      "| floors | maps | rms at most 0.10 m | loops open | track broken | median m | worst m |\n"
      "|---|---|---|---|---|---|---|\n");
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    if (!outcomes.at(kind).empty()) print_row(kKinds.at(kind).name, outcomes.at(kind));
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t floors = 51;
  std::uint64_t first_seed = 1;
  MotionInScan motion = MotionInScan::kNone;
  bool verbose = false;
  topogeo::command_line::Command app("Maps by a laser that is carried through a floor",
                                     "topogeo_hand_held");
  app.add_option("--floors", floors, "number of floors")->capture_default_str();
  app.add_option("--first-seed", first_seed, "seed of the first floor")->capture_default_str();
  app.add_option_function(
         "--motion",
         [&](const std::string& name) {
           if (name == "known") motion = MotionInScan::kKnownTimes;
           if (name == "unknown") motion = MotionInScan::kUnknownTimes;
         },
         "the laser moves during a scan, and the times of the beams are known, or are not")
      ->check(topogeo::command_line::one_of({"none", "known", "unknown"}));
  app.add_flag("--verbose", verbose, "also print each map");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    return run(floors, first_seed, motion, verbose);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_hand_held: %s\n", error.what());
    return 1;
  }
}
