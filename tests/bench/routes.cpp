// How often each planner finds a route between two poses of a drive.
//
//   topogeo_routes [--pairs N] [--seed N] [--verbose] LOG...
//
// Each log is mapped; pairs of its stops are drawn at random. "grid": the hybrid planner alone;
// "branches": nodes and branches alone, without and with the grid beside them; "live": the planner
// service's order, where the second planner answers when the first has no route, in both orders.
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/hybrid_map_source.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/planning/goal_planner.hpp"
#include "topogeo/scan/carmen_log_reader.hpp"
#include "topogeo/support/cpu_time.hpp"
#include "topogeo/support/random.hpp"

namespace {

using namespace topogeo;

struct RouteOptions {
  std::size_t pairs = 40;
  std::uint64_t seed = 1;
  bool verbose = false;
  std::vector<std::string> logs;
};

struct Column {
  const char* name;
  planning::PlanningMaps maps;
  planning::PlanFirstOn on = planning::PlanFirstOn::kHybrid;
  std::size_t found = 0;
  double ms = 0.0;
  double length_m = 0.0;
  double least_m = 0.0;  // sum of the least clearances of routes
  double virtual_m = 0.0;
  double off_m = 0.0;
};

storage::MapDocument map_of(const std::string& file, const pipeline::Config& config) {
  scan::CarmenLogReader reader(file, config.log);
  pipeline::MappingRun run(config, "robot");
  while (const auto scan = reader.next()) run.add(*scan);
  return run.finish();
}

void evaluate(const std::string& file, const RouteOptions& options) {
  const pipeline::Config config;
  const std::string name = std::filesystem::path(file).stem().stem().string();
  const storage::MapDocument document = map_of(file, config);
  const planning::HybridMap hybrid =
      pipeline::make_hybrid_map(pipeline::parts_of(document), config.hybrid_map);
  const topomap::GlobalMap* graph = &document.global_map;
  std::array<Column, 5> columns{
      {{"grid", {&hybrid, nullptr}},
       {"branches, no grid", {nullptr, graph}},
       {"branches first", {&hybrid, graph}, planning::PlanFirstOn::kGraph},
       {"live, hybrid", {&hybrid, graph}},
       {"live, graph", {&hybrid, graph}, planning::PlanFirstOn::kGraph}}};
  std::vector<Eigen::Vector2d> driven_m;
  for (const topomap::StopPose& stop : document.trajectory.stops) {
    if (stop.located) driven_m.push_back(stop.T_map_robot.position_m());
  }
  support::Random random(options.seed);
  for (std::size_t pair = 0; pair < options.pairs; ++pair) {
    const Eigen::Vector2d from_m = driven_m[random.below(driven_m.size())];
    const Eigen::Vector2d to_m = driven_m[random.below(driven_m.size())];
    for (Column& column : columns) {
      planning::GoalPlannerConfig settings{{column.on}, config.hybrid_planner, config.planning};
      const double start_s = support::process_cpu_s();
      const planning::HybridRoute route =
          planning::plan_to_goal(column.maps, from_m, to_m, {}, settings);
      column.ms += 1e3 * (support::process_cpu_s() - start_s);
      if (!route.found()) {
        if (options.verbose) {
          std::printf("%s %zu %s: %s\n", name.c_str(), pair, column.name, route.reason.c_str());
        }
        continue;
      }
      ++column.found;
      column.length_m += route.length_m;
      column.least_m += route.min_clearance_m;
      column.virtual_m += planning::length_on(route, planning::PlannedOn::kVirtualBranch);
      column.off_m += planning::length_on(route, planning::PlannedOn::kOffBranch);
    }
  }
  for (const Column& column : columns) {
    const auto found = static_cast<double>(column.found);
    std::printf("| %s | %s | %zu of %zu | %.2f | %.2f | %.2f | %.2f | %.2f |\n", name.c_str(),
                column.name, column.found, options.pairs, column.length_m / found,
                column.least_m / found, column.virtual_m / found, column.off_m / found,
                column.ms / static_cast<double>(options.pairs));
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app("How often each planner finds a route between poses that were driven.");
  RouteOptions options;
  app.add_option("--pairs", options.pairs, "of poses for each log")->type_name("N");
  app.add_option("--seed", options.seed, "of their choice")->type_name("N");
  app.add_flag("--verbose", options.verbose, "show each pair without a route");
  app.add_option("logs", options.logs, "CARMEN logs")->required()->type_name("LOG");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  std::printf(
      "| log | planner | found | mean length m | mean least clearance m | virtual m | off m "
      "| ms |\n|---|---|---|---|---|---|---|---|\n");
  try {
    for (const std::string& log : options.logs) evaluate(log, options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_routes: %s\n", error.what());
    return 1;
  }
  return 0;
}
