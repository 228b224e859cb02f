// Whether a robot localizes at a place that it visited before: at revisits in recorded logs, and in
// the maps of other days.
//
//   topogeo_revisits [--data FOLDER] [--most N] [--scans N] [--verbose] [--json FILE] NAME[/N]...
//   topogeo_revisits --sessions NAME NAME NAME...
//
// Revisits: the map of all scans that are 30 or more before one, with the reference as odometry,
// then the scans from there on as recorded, without an initial pose (revisit_runs.hpp). Sessions:
// each log continues the map of each other one (session_runs.hpp).
#include <algorithm>
#include <atomic>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <mutex>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/pipeline/laser_mounting.hpp"
#include "topogeo/scan/laser_mounting.hpp"
#include "topogeo/support/format.hpp"

#include "revisit_runs.hpp"
#include "session_runs.hpp"

namespace {

using namespace topogeo;

struct RevisitCommand {
  std::vector<std::string> logs;
  bool sessions = false;
  std::filesystem::path data = "../shared/data";
  std::optional<std::filesystem::path> config_file;
  std::optional<std::filesystem::path> json_file;
  bench::RevisitOptions revisits;
  std::size_t jobs = 2;
  bool verbose = false;
};

/// Runs work(i) for i below `count`, in `jobs` threads; throws the first error of any of them.
template <typename Work>
void in_parallel(std::size_t count, std::size_t jobs, const Work& work) {
  std::atomic<std::size_t> next = 0;
  std::exception_ptr error;
  std::mutex failing;
  const auto take = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        work(i);
      } catch (...) {
        const std::scoped_lock lock(failing);
        if (!error) error = std::current_exception();
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < std::min(jobs, count); ++i) threads.emplace_back(take);
  for (std::thread& thread : threads) thread.join();
  if (error) std::rethrow_exception(error);
}

// --- revisits

struct RevisitRow {
  std::string name;
  std::size_t found = 0;
  std::size_t tracking = 0;
  std::size_t wrong = 0;
  std::vector<bench::RevisitRun> runs;

  [[nodiscard]] double median_m() const {
    std::vector<double> path_m;
    for (const bench::RevisitRun& run : runs) {
      if (run.found_m()) path_m.push_back(*run.found_m());
    }
    std::sort(path_m.begin(), path_m.end());
    return path_m.empty() ? 0.0 : path_m[path_m.size() / 2];
  }
};

RevisitRow measure(const std::string& text, const RevisitCommand& options) {
  const std::size_t slash = text.find('/');
  const std::string name = text.substr(0, slash);
  const std::size_t every = slash == std::string::npos ? 1 : std::stoul(text.substr(slash + 1));
  if (every == 0) throw std::runtime_error(text + ": expected NAME or NAME/N with N from 1");
  pipeline::LoadedConfig config = pipeline::load_config(options.config_file);
  const std::string file = (options.data / name).string();
  static_cast<void>(pipeline::choose_mounting(config, scan::mounting_in_log(file + ".clf.gz")));
  bench::Recording recording =
      bench::recorded(file + ".clf.gz", file + ".ref.tum", config.config.log);
  if (every > 1) recording = bench::thinned(recording, every);
  RevisitRow row{text, 0, 0, 0, bench::run_revisits(recording, config.config, options.revisits)};
  for (const bench::RevisitRun& run : row.runs) {
    row.found += run.found_m() ? 1 : 0;
    row.tracking += run.tracking();
    row.wrong += run.wrong();
  }
  return row;
}

double slowest_ms(const RevisitRow& row) {
  std::vector<double> ms;
  for (const bench::RevisitRun& run : row.runs) {
    for (const bench::RevisitStop& stop : run.stops) ms.push_back(stop.step_ms);
  }
  std::sort(ms.begin(), ms.end());
  return ms.empty() ? 0.0 : ms[ms.size() * 99 / 100];
}

void print(const RevisitRow& row) {
  std::cout << fmt::format("| {} | {} | {} | {:.1f} | {} | {} | {:.0f} |\n", row.name,
                           row.runs.size(), row.found, row.median_m(), row.tracking, row.wrong,
                           slowest_ms(row))
            << std::flush;
}

void print_details(const RevisitRow& row) {
  for (const bench::RevisitRun& run : row.runs) {
    const std::string found =
        run.found_m() ? fmt::format("found after {:.1f} m", *run.found_m()) : "not found";
    std::cerr << fmt::format("{}: scan {}, {} stops of map: {}, {} of {} TRACKING wrong;", row.name,
                             run.first_scan, run.map_stops, found, run.wrong(), run.tracking());
    for (const bench::RevisitStop& stop : run.stops) {
      const char letter = "TASL"[static_cast<std::size_t>(stop.state)];
      std::cerr << fmt::format(" {}{:.2f}", letter, stop.off_m);
    }
    std::cerr << '\n';
  }
}

nlohmann::json run_logs(const RevisitCommand& options) {
  std::cout << "| log | revisits | found | after m, median | TRACKING stops | wrong | step ms, p99 "
               "|\n|---|---|---|---|---|---|---|\n"
            << std::flush;
  std::vector<RevisitRow> rows(options.logs.size());
  std::mutex printing;
  in_parallel(rows.size(), options.jobs, [&](std::size_t i) {
    rows[i] = measure(options.logs[i], options);
    const std::scoped_lock lock(printing);
    print(rows[i]);
    if (options.verbose) print_details(rows[i]);
  });
  RevisitRow all;
  all.name = "all";
  nlohmann::json json;
  for (RevisitRow& row : rows) {
    json["logs"].push_back({{"log", row.name},
                            {"revisits", row.runs.size()},
                            {"found", row.found},
                            {"found_after_m", row.median_m()},
                            {"tracking", row.tracking},
                            {"wrong", row.wrong}});
    all.found += row.found;
    all.tracking += row.tracking;
    all.wrong += row.wrong;
    std::move(row.runs.begin(), row.runs.end(), std::back_inserter(all.runs));
  }
  print(all);
  return json;
}

// --- sessions

nlohmann::json run_sessions(const RevisitCommand& options) {
  std::vector<bench::SessionDrive> drives(options.logs.size());
  in_parallel(drives.size(), options.jobs, [&](std::size_t i) {
    drives[i] = bench::session_drive((options.data / (options.logs[i] + ".clf.gz")).string(),
                                     options.logs[i], pipeline::load_config(options.config_file));
  });
  std::vector<bench::SessionPair> pairs;
  std::vector<std::pair<std::size_t, std::size_t>> wanted;
  for (std::size_t a = 0; a < drives.size(); ++a) {
    for (std::size_t b = 0; b < drives.size(); ++b) {
      if (a != b) wanted.emplace_back(a, b);
    }
  }
  pairs.resize(wanted.size());
  in_parallel(wanted.size(), options.jobs, [&](std::size_t i) {
    pairs[i] = bench::run_pair(drives, wanted[i].first, wanted[i].second);
  });
  std::cout << "| map | drive | stops joined | after m | x m | y m | heading degrees | spread m "
               "|\n|---|---|---|---|---|---|---|---|\n";
  constexpr double kDegree = std::numbers::pi / 180.0;
  nlohmann::json json;
  for (const bench::SessionPair& pair : pairs) {
    const std::string& stored = drives[pair.stored].name;
    const std::string& later = drives[pair.later].name;
    json["pairs"].push_back({{"map", stored},
                             {"drive", later},
                             {"stops", pair.stops},
                             {"joined", pair.joined},
                             {"x_m", pair.T_stored_later.x_m},
                             {"y_m", pair.T_stored_later.y_m},
                             {"heading_rad", pair.T_stored_later.theta_rad}});
    if (options.verbose) {
      std::cerr << fmt::format("{} in {}:", later, stored);
      for (const bench::FollowedStop& stop : pair.followed) {
        std::cerr << fmt::format(
            " {}{:.1f}{}({:.2f} {:.2f} {:.0f})", "TASL"[static_cast<std::size_t>(stop.state)],
            stop.path_m, stop.contradicted ? fmt::format("/{:.2f}", *stop.contradicted) : "",
            stop.T_stored_later.x_m, stop.T_stored_later.y_m,
            stop.T_stored_later.theta_rad / kDegree);
      }
      std::cerr << '\n';
    }
    if (!pair.joined_after_m) {
      std::cout << fmt::format("| {} | {} | 0 of {} | - | - | - | - | - |\n", stored, later,
                               pair.stops);
      continue;
    }
    std::cout << fmt::format(
        "| {} | {} | {} of {} | {:.1f} | {:.3f} | {:.3f} | {:.2f} | {:.3f} |\n", stored, later,
        pair.joined, pair.stops, *pair.joined_after_m, pair.T_stored_later.x_m,
        pair.T_stored_later.y_m, pair.T_stored_later.theta_rad / kDegree, pair.spread_m);
  }
  std::cout << "\n| round | closes to m | degrees |\n|---|---|---|\n";
  for (const bench::SessionCycle& cycle : bench::cycles_of(pairs, drives.size())) {
    std::string round;
    for (const std::size_t drive : cycle.drives) round += drives[drive].name + ", ";
    round += drives[cycle.drives.front()].name;
    std::cout << fmt::format("| {} | {:.3f} | {:.2f} |\n", round, cycle.closing_m,
                             cycle.closing_rad / kDegree);
    json["rounds"].push_back(
        {{"drives", round}, {"closing_m", cycle.closing_m}, {"closing_rad", cycle.closing_rad}});
  }
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"whether a robot finds its place where it has been before"};
  RevisitCommand options;
  app.add_option("log", options.logs, "NAME, or NAME/N: every N-th scan of it alone")
      ->required()
      ->type_name("NAME");
  app.add_flag("--sessions", options.sessions, "each log continues the map of each other one");
  app.add_option("--data", options.data, "folder of NAME.clf.gz and NAME.ref.tum")
      ->type_name("FOLDER")
      ->capture_default_str();
  app.add_option("--config", options.config_file, "configuration file")->type_name("FILE");
  app.add_option("--most", options.revisits.most, "revisits of a log, spread over it")
      ->capture_default_str();
  app.add_option("--scans", options.revisits.scans, "of a revisit")->capture_default_str();
  app.add_option("--json", options.json_file, "the figures as well")->type_name("FILE");
  app.add_option("--jobs", options.jobs, "logs at a time")
      ->check(command_line::range(1.0, 256.0))
      ->capture_default_str();
  app.add_flag("--verbose", options.verbose,
               "of each revisit the state (tracking, ambiguous, lost, searching) and the error in "
               "metres at its stops; of each session the state and where its map would lie");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    const nlohmann::json json = options.sessions ? run_sessions(options) : run_logs(options);
    if (options.json_file) std::ofstream(*options.json_file) << json.dump(2) << '\n';
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "topogeo_revisits: " << error.what() << '\n';
    return 1;
  }
}
