// Explores three simulated floors from unknown starts in a closed loop and prints a table.
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <future>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/render/route_picture.hpp"
#include "topogeo/support/atomic_file.hpp"
#include "topogeo/support/format.hpp"

#include "exploration_run.hpp"

namespace topogeo::bench {
namespace {

struct ExplorationOptions {
  std::string floor;  ///< empty: all
  std::uint64_t first_seed = 1;
  std::uint64_t starts = 3;
  unsigned jobs = 1;
  std::string wheels = "mild";
  std::optional<std::filesystem::path> pictures;
  bool verbose = false;
};

struct Run {
  std::string floor;
  std::uint64_t seed = 0;
  ExplorationResult result;
};

Run carry_out(const ExplorationOptions& options, const std::string& floor, std::uint64_t seed) {
  ExplorationConfig config;
  config.wheels = options.wheels == "b21" ? Wheels::kB21 : Wheels::kMild;
  ExplorationRecord record;
  Run run{floor, seed, explore(floor, config, seed, &record)};
  if (options.pictures && record.map) {
    planning::HybridRoute path;
    path.status = planning::RouteStatus::kFound;
    path.points_m = record.path_m;
    std::string name = fmt::format("{}_{}.png", floor, seed);
    for (char& c : name) c = c == ' ' ? '_' : c;
    support::write_file_atomically(
        *options.pictures / name,
        render::route_picture(*record.map, path,
                              fmt::format("{}, start {}: {:.0f} m, {:.1f} % seen", floor, seed,
                                          run.result.path_m, 100.0 * run.result.seen),
                              render::PictureFormat::kPng));
  }
  if (options.verbose) {
    for (const std::string& line : record.log) std::cerr << line << '\n';
  }
  return run;
}

std::string line_of(const Run& run) {
  const ExplorationResult& r = run.result;
  return fmt::format(
      "| {} | {} | {:.2f} % | {} of {} | {} | {:.0f} | {:.0f} | {:.2f} | {:.0f} | {} | {} | {} | "
      "{:.3f} | {} |\n",
      run.floor, run.seed, 100.0 * r.seen, r.entered, r.rooms, r.collisions, r.path_m, r.scripted_m,
      r.path_m / r.scripted_m, r.time_s, r.targets, r.given_up, r.stops, r.pose_error_m,
      r.done ? "done" : r.end);
}

void print(const std::vector<Run>& runs) {
  std::cout
      << "| floor | start | seen | rooms | collisions | way m | scripted m | ratio | time s | "
         "targets | given up | stops | pose rms m | end |\n"
         "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Run& run : runs) std::cout << line_of(run);
}

int run_all(const ExplorationOptions& options) {
  std::vector<std::pair<std::string, std::uint64_t>> wanted;
  for (const std::string_view floor : kNavigationFloors) {
    if (!options.floor.empty() && options.floor != floor) continue;
    for (std::uint64_t i = 0; i < options.starts; ++i) {
      wanted.emplace_back(floor, options.first_seed + i);
    }
  }
  std::vector<Run> runs(wanted.size());
  std::vector<std::future<void>> jobs;
  for (unsigned job = 0; job < options.jobs; ++job) {
    jobs.push_back(std::async(std::launch::async, [&, job] {
      for (std::size_t i = job; i < wanted.size(); i += options.jobs) {
        runs[i] = carry_out(options, wanted[i].first, wanted[i].second);
        std::cerr << line_of(runs[i]);
      }
    }));
  }
  for (std::future<void>& job : jobs) job.get();
  print(runs);
  return EXIT_SUCCESS;
}

}  // namespace
}  // namespace topogeo::bench

int main(int argc, char** argv) {
  using namespace topogeo::bench;  // NOLINT(google-build-using-namespace)
  topogeo::command_line::Command app{"Explores simulated floors from unknown starts"};
  ExplorationOptions options;
  app.add_option("--floor", options.floor, "one of them alone")
      ->check(topogeo::command_line::one_of({"office", "warehouse", "two loops"}));
  app.add_option("--seed", options.first_seed, "of the first start")->capture_default_str();
  app.add_option("--starts", options.starts, "on each floor")->capture_default_str();
  app.add_option("--jobs", options.jobs, "runs at the same time")
      ->check(topogeo::command_line::range(1, 64))
      ->capture_default_str();
  app.add_option("--wheels", options.wheels, "how odometry errs")
      ->check(topogeo::command_line::one_of({"mild", "b21"}))
      ->capture_default_str();
  app.add_option("--pictures", options.pictures, "directory for a picture of each run")
      ->check(topogeo::command_line::existing_directory());
  app.add_flag("--verbose", options.verbose, "print each target");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    return run_all(options);
  } catch (const std::exception& error) {
    std::cerr << "topogeo_exploration: " << error.what() << '\n';
    return EXIT_FAILURE;
  }
}
