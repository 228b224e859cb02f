// Measures which places of recorded logs are recognized, and whether covariances fit the errors.
//
//   topogeo_loops [--config FILE] [--jobs J] [--data FOLDER] [--verbose] [--floors N]
//                 [--reliability] [--decisions FILE] NAME[/N]...
//
// Maps NAME.clf.gz of the folder, as topogeo map does, NAME/N with only every N-th scan, and prints
// one row of a table: errors against NAME.ref.tum and NAME.relations, revisits
// (pipeline/loop_recall.hpp) and mean squared Mahalanobis distances (covariance_checks.hpp).
// --floors adds drives through synthetic floors, --reliability checks whether the probabilities of
// the decisions are right (loop_reliability.hpp).
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/scan/laser_mounting.hpp"
#include "topogeo/support/format.hpp"

#include "loop_figures.hpp"
#include "synthetic_run.hpp"

namespace {

using namespace topogeo;

struct LoopOptions {
  std::vector<std::string> logs;
  std::filesystem::path data = "../shared/data";
  std::optional<std::filesystem::path> config_file;
  std::size_t jobs = 2;
  std::uint64_t floors = 0;  // seeds of each synthetic floor
  bool reliability = false;
  std::optional<std::filesystem::path> decisions;
  bool verbose = false;
};

/// A log of the command line.
struct LogName {
  std::string name;
  std::size_t every = 1;
};

LogName parse_log(const std::string& text) {
  const std::size_t slash = text.find('/');
  if (slash == std::string::npos) return {text, 1};
  const std::string every = text.substr(slash + 1);
  const bool digits = !every.empty() && every.size() < 6 &&
                      every.find_first_not_of("0123456789") == std::string::npos;
  if (!digits || std::stoul(every) == 0) {
    throw std::runtime_error("expected NAME or NAME/N with N from 1");
  }
  return {text.substr(0, slash), std::stoul(every)};
}

/// NAME/floor/SEED of each synthetic drive, for instance "cyclic floor/floor/3".
constexpr const char* kFloor = "/floor/";

std::vector<std::string> synthetic_drives(std::uint64_t seeds) {
  std::vector<std::string> names;
  for (const bench::SyntheticFloor& floor : bench::synthetic_floors()) {
    if (floor.large) continue;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
      names.push_back(floor.name + kFloor + std::to_string(seed));
    }
  }
  return names;
}

bench::LoopFigures measure_floor(const std::string& text, const pipeline::Config& config) {
  const std::size_t end = text.find(kFloor);
  const std::uint64_t seed = std::stoull(text.substr(end + std::string(kFloor).size()));
  for (const bench::SyntheticFloor& floor : bench::synthetic_floors()) {
    if (floor.name != text.substr(0, end)) continue;
    simulation::SimulatedLog log = bench::synthetic_drive(floor.draw(seed), seed);
    bench::Recording recording{text, std::move(log.scans), {}};
    recording.T_world_robot.assign(log.T_world_robot.begin(), log.T_world_robot.end());
    return bench::measure_loops(recording, config, std::nullopt);
  }
  throw std::runtime_error("no such floor");
}

bench::LoopFigures measure(const std::string& text, const LoopOptions& options,
                           pipeline::LoadedConfig config) {
  if (text.find(kFloor) != std::string::npos) return measure_floor(text, config.config);
  const LogName log = parse_log(text);
  const std::filesystem::path file = options.data / log.name;
  const std::string scans = file.string() + ".clf.gz";
  static_cast<void>(pipeline::choose_mounting(config, scan::mounting_in_log(scans)));
  bench::Recording recording =
      bench::recorded(scans, file.string() + ".ref.tum", config.config.log);
  if (log.every > 1) recording = bench::thinned(recording, log.every);
  std::optional<std::filesystem::path> relations = file.string() + ".relations";
  if (!std::filesystem::exists(*relations)) relations.reset();
  return bench::measure_loops(recording, config.config, relations);
}

std::string metres(const std::optional<pipeline::RelationSpread>& relations) {
  return relations ? fmt::format("{:.4f}", relations->mean_m) : "-";
}

void print_head() {
  std::cout << "| log | ate m | loop m | relations, all m | relations, far m | revisits | tried | "
               "accepted | in view | of them accepted | wrong | triangles | predictions | stops | "
               "tasks | CPU s |\n"
               "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n"
            << std::flush;
}

void print_row(const bench::LoopFigures& f) {
  const auto loop = f.error.loop ? fmt::format("{:.3f}", f.error.loop->mean_m) : "-";
  const auto relations = f.relations.value_or(pipeline::RelationsError{});
  std::cout << fmt::format("| {} | {:.3f} | {} | {} | {} ", f.name, f.error.rms_m, loop,
                           metres(relations.all), metres(relations.far))
            << fmt::format("| {} | {} | {} | {} | {} | {} ", f.recall.revisits.size(),
                           f.recall.tried(), f.recall.accepted(), f.recall.in_view(),
                           f.recall.accepted_in_view(), f.recall.wrong())
            << fmt::format("| {:.2f} ({}) | {:.2f} ({}) ", f.triangles.mean(), f.triangles.count,
                           f.predictions.mean(), f.predictions.count)
            << fmt::format("| {} | {} | {:.1f} |\n", f.stops, f.match_tasks, f.cpu_s) << std::flush;
}

/// Decisions by source and outcome, loops off the reference and revisits without a loop.
void print_details(const bench::LoopFigures& f) {
  for (const pipeline::LoopOutcomeCounts& of : f.recall.outcomes) {
    std::cerr << fmt::format("{}: {} {}: {} right, {} near, {} wrong\n", f.name, of.source,
                             of.outcome, of.right, of.near, of.wrong);
  }
  for (const pipeline::LoopOffReference& off : f.recall.off_reference) {
    std::cerr << fmt::format(
        "{}: loop {} - {} ({}) is {:.2f} m {:.2f} rad off, in common {:.2f}, by the reference "
        "{:.2f}; correction {:.2f} m, predicted to {:.2f} m\n",
        f.name, off.loop.earlier_id, off.loop.later_id, off.loop.source, off.off_m, off.off_rad,
        off.in_common, off.in_common_by_reference, off.loop.correction_m,
        off.loop.predicted_sigma_m);
  }
  for (const pipeline::Revisit& revisit : f.recall.revisits) {
    if (revisit.accepted) continue;
    std::cerr << fmt::format("{}: stop {} not recognized ({}{})\n", f.name, revisit.stop,
                             revisit.tried ? "tried" : "not tried",
                             revisit.in_view ? ", in view" : "");
  }
}

/// Prints the drives through one synthetic floor together as one log.
void print_judged(const LoopOptions& options,
                  const std::map<std::size_t, bench::JudgedLog>& judged) {
  std::vector<bench::JudgedLog> logs;
  for (const auto& [index, log] : judged) {
    const bool floor = log.name.find(kFloor) != std::string::npos;
    if (!floor) {
      logs.push_back(log);
      continue;
    }
    const std::string name = log.name.substr(0, log.name.find(kFloor));
    if (logs.empty() || logs.back().name != name) logs.push_back({name, false, {}});
    std::vector<bench::JudgedDecision>& all = logs.back().decisions;
    all.insert(all.end(), log.decisions.begin(), log.decisions.end());
  }
  if (options.reliability) bench::print_reliability(std::cout, logs);
  if (options.decisions) {
    std::ofstream out(*options.decisions);
    bench::write_decisions(out, logs);
  }
}

/// Prints each log as soon as it is done; returns whether all could be measured.
bool print_logs(const LoopOptions& options, const pipeline::LoadedConfig& config) {
  std::map<std::size_t, bench::JudgedLog> judged;
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> all_measured = true;
  std::mutex printing;
  const auto work = [&] {
    for (std::size_t i = next++; i < options.logs.size(); i = next++) {
      try {
        bench::LoopFigures figures = measure(options.logs[i], options, config);
        const std::scoped_lock lock(printing);
        print_row(figures);
        if (options.verbose) print_details(figures);
        judged[i] = {options.logs[i], true, std::move(figures.decisions)};
      } catch (const std::exception& error) {
        const std::scoped_lock lock(printing);
        std::cerr << fmt::format("topogeo_loops: {}: {}\n", options.logs[i], error.what());
        all_measured = false;
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < std::min(options.jobs, options.logs.size()); ++i) {
    threads.emplace_back(work);
  }
  for (std::thread& thread : threads) thread.join();
  print_judged(options, judged);
  return all_measured;
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{
      "which places of recorded logs are recognized, and whether covariances fit the errors"};
  LoopOptions options;
  app.add_option("log", options.logs, "NAME, or NAME/N: every N-th scan of it alone")
      ->type_name("NAME");
  app.add_option("--floors", options.floors,
                 "drives through each synthetic floor but the large ones as well")
      ->check(command_line::range(0.0, 1000.0));
  app.add_flag("--reliability", options.reliability,
               "whether the probabilities of the decisions are right");
  app.add_option("--decisions", options.decisions, "write what each decision was made of")
      ->type_name("FILE");
  app.add_option("--data", options.data, "folder of NAME.clf.gz, NAME.ref.tum, NAME.relations")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_option("--config", options.config_file, "configuration file")->type_name("FILE");
  app.add_option("--jobs", options.jobs, "logs at a time")
      ->check(command_line::range(1.0, 256.0))
      ->capture_default_str();
  app.add_flag("--verbose", options.verbose,
               "decisions by source and outcome, loops off the reference, places not recognized");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  for (const std::string& drive : synthetic_drives(options.floors)) options.logs.push_back(drive);
  try {
    const pipeline::LoadedConfig config = pipeline::load_config(options.config_file);
    print_head();
    return print_logs(options, config) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "topogeo_loops: " << error.what() << '\n';
    return 1;
  }
}
