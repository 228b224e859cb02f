// How fast a lost robot searches the whole of a large map, by the number of search workers.
//
//   topogeo_lost_robot [--path M] [--starts N] [--stops K] [--workers W] [--rounds R] [--map FILE]
//
// A floor is mapped in one drive and driven again with other noise; the robot is lost at N stops of
// the second drive, evenly spread, and adds K stops from each of them while it searches, without an
// initial pose. "Whole map": from the request to all results of a search of the whole map; "stop":
// all work for a stop of a lost robot, including its matches. "by CPU": CPU time of the localizer
// plus an equal share of the workers' CPU time; this is the time of a search on idle cores, where
// the localizer waits for the workers, and other programs do not change it. Everything is real: the
// localizer's end of the pool, DDS, workers in processes of one slot. The poses of all stops must
// be the same bytes with any number of workers.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iterator>
#include <list>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/matching/match.hpp"
#include "topogeo/pipeline/localization_run.hpp"
#include "topogeo/pipeline/mapping_run.hpp"
#include "topogeo/relocalization/map_tracker.hpp"
#include "topogeo/simulation/random_floors.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/storage/map_file.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "pool_peers.hpp"

namespace {

using namespace topogeo;
using MapPointer = std::shared_ptr<const topomap::LocalMap>;

struct LostOptions {
  double path_m = 2000.0;
  std::size_t blocks = 4;
  std::size_t starts = 12;
  std::size_t stops = 5;
  std::size_t least_workers = 0;
  std::size_t most_workers = 2;
  std::size_t rounds = 5;
  std::string scheduling;
  std::filesystem::path map;
};

simulation::SimulatedLog drive(const LostOptions& options, std::uint64_t seed) {
  simulation::SimulationOptions simulation;
  simulation.seed = seed;
  simulation.scan_step_m = 0.5;
  simulation.scan_step_rad = 45.0 * std::numbers::pi / 180.0;
  simulation.odometry = simulation::b21_odometry(seed);
  return simulation::simulate_log(simulation::large_floor(1, options.path_m, options.blocks),
                                  simulation);
}

std::shared_ptr<const localization::StoredMap> make_map(const LostOptions& options,
                                                        const pipeline::Config& config) {
  if (!options.map.empty() && std::filesystem::exists(options.map)) {
    return pipeline::load_stored_map(options.map);
  }
  pipeline::MappingRun mapping(config, "robot");
  for (const scan::Scan& scan : drive(options, 1).scans) mapping.add(scan);
  const storage::MapDocument document = mapping.finish();
  if (!options.map.empty()) storage::write_map_file(options.map, document);
  return pipeline::stored_map(document);
}

std::vector<MapPointer> stops_of(const LostOptions& options, const pipeline::Config& config) {
  pipeline::LocalMapper mapper(config.local_mapper, "robot");
  std::vector<MapPointer> stops;
  for (const scan::Scan& scan : drive(options, 2).scans) {
    if (auto map = mapper.add(scan)) {
      stops.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    }
  }
  return stops;
}

/// The stops at which the robot is lost and those that follow: each start a session of its own.
std::vector<std::vector<MapPointer>> drives_of(const LostOptions& options,
                                               const std::vector<MapPointer>& stops) {
  std::vector<std::vector<MapPointer>> drives;
  for (std::size_t i = 0; i < options.starts; ++i) {
    const std::size_t first = i * (stops.size() - options.stops) / options.starts;
    std::vector<MapPointer>& drive = drives.emplace_back();
    for (std::size_t k = 0; k < options.stops; ++k) {
      auto map = std::make_shared<topomap::LocalMap>(*stops.at(first + k));
      map->stop = {1000 + i, static_cast<std::uint32_t>(k)};
      drive.push_back(std::move(map));
    }
  }
  return drives;
}

/// A pool that measures how long searches of whole maps take.
class TimedPool : public localization::MatchPool {
 public:
  explicit TimedPool(localization::MatchPool& pool) : pool_(pool) {}
  void add_map(MapPointer map) override { pool_.add_map(std::move(map)); }
  void add_field(std::shared_ptr<const localization::PlaceField> field) override {
    pool_.add_field(std::move(field));
  }
  std::vector<localization::MatchResult> match(
      std::span<const localization::MatchTask> tasks) override {
    const bench::Clock::time_point start = bench::Clock::now();
    std::vector<localization::MatchResult> results = pool_.match(tasks);
    if (!tasks.empty() && tasks.front().places) {
      whole_map_ms_.push_back(1e3 * bench::seconds_since(start));
    }
    return results;
  }
  /// Times since the last call.
  std::vector<double> take_whole_map_ms() { return std::exchange(whole_map_ms_, {}); }

 private:
  localization::MatchPool& pool_;
  std::vector<double> whole_map_ms_;
};

struct Result {
  std::vector<double> whole_map_ms;  // of each search of the whole map
  std::vector<double> wall_ms;       // of each stop that was searched for
  double cpu_s = 0.0;                // of this process, meanwhile
  double workers_s = 0.0;            // of all workers, meanwhile
  std::size_t found = 0;
  std::vector<localization::LocalizedStop> stops;
};

std::vector<double> cpu_of(const bench::Workers& workers) {
  std::vector<double> cpu_s;
  for (std::size_t i = 0; i < workers.size(); ++i) cpu_s.push_back(workers.cpu_s(i));
  return cpu_s;
}

Result search_lost(const LostOptions& options, localization::MapTracker& tracker,
                   const std::vector<std::vector<MapPointer>>& drives, bench::PoolClient& client,
                   const bench::Workers& workers) {
  Result result;
  for (const std::vector<MapPointer>& drive : drives) {
    tracker.search();
    bool found = false;
    for (const MapPointer& stop : drive) {
      const std::vector<double> workers_before_s = cpu_of(workers);
      const double before_s = support::process_cpu_s();
      const bench::Clock::time_point start = bench::Clock::now();
      client.publish({stop});  // as the local mapper does
      tracker.add(stop);
      if (!found) {
        result.wall_ms.push_back(1e3 * bench::seconds_since(start));
        result.cpu_s += support::process_cpu_s() - before_s;
        for (std::size_t i = 0; i < workers.size(); ++i) {
          result.workers_s += workers.cpu_s(i) - workers_before_s[i];
        }
      }
      found |= tracker.status().state == localization::LocalizationState::kTracking;
    }
    result.found += found ? 1 : 0;
  }
  const std::size_t count = options.starts * options.stops;
  result.stops.assign(tracker.stops().end() - static_cast<std::ptrdiff_t>(count),
                      tracker.stops().end());
  return result;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

bool same(const Result& a, const Result& b) {
  return std::equal(a.stops.begin(), a.stops.end(), b.stops.begin(), b.stops.end(),
                    [](const auto& s, const auto& t) {
                      return localization::identical(s.T_map_robot, t.T_map_robot) &&
                             s.status.state == t.status.state;
                    });
}

/// A localizer and its workers.
class Team {
 public:
  Team(const LostOptions& options, std::size_t workers, const pipeline::Config& config,
       std::shared_ptr<const localization::StoredMap> map)
      : client_({}) {
    std::vector<std::string> flags;
    if (!options.scheduling.empty()) flags = {"--scheduling", options.scheduling};
    for (std::size_t i = 0; i < workers; ++i) workers_.start_real(client_, flags);
    if (client_.pool().wait_for_workers(workers, bench::kPatience) < workers) {
      throw std::runtime_error("the workers did not come; " + client_.fault());
    }
    tracker_.emplace(config.localizer, std::move(map), pool_);
  }

  /// Throws std::runtime_error when the pool reported a fault.
  Result search(const LostOptions& options, const std::vector<std::vector<MapPointer>>& drives) {
    static_cast<void>(pool_.take_whole_map_ms());
    Result result = search_lost(options, *tracker_, drives, client_, workers_);
    result.whole_map_ms = pool_.take_whole_map_ms();
    if (!client_.fault().empty()) throw std::runtime_error(client_.fault());
    return result;
  }

 private:
  bench::PoolClient client_;
  TimedPool pool_{client_.pool()};
  bench::Workers workers_;
  std::optional<localization::MapTracker> tracker_;
};

void append(Result& all, const Result& one) {
  all.whole_map_ms.insert(all.whole_map_ms.end(), one.whole_map_ms.begin(), one.whole_map_ms.end());
  all.wall_ms.insert(all.wall_ms.end(), one.wall_ms.begin(), one.wall_ms.end());
  all.cpu_s += one.cpu_s;
  all.workers_s += one.workers_s;
  all.found += one.found;
}

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// CPU time for each stop, with the workers' share.
double cpu_ms(const Result& result, std::size_t workers) {
  const double s =
      result.cpu_s + result.workers_s / static_cast<double>(std::max<std::size_t>(1, workers));
  return 1e3 * s / static_cast<double>(result.wall_ms.size());
}

void print(const std::vector<Result>& results, std::size_t least_workers, std::size_t starts) {
  std::printf(
      "| workers | found | stops searched | whole map, ms, median | times as fast as one | "
      "stop, ms, median | mean | most | times as fast as one, median | mean | by CPU | "
      "CPU of the localizer, ms a stop | of the workers |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < results.size(); ++i) {
    const Result& result = results[i];
    const std::size_t workers = least_workers + i;
    const auto count = static_cast<double>(result.wall_ms.size());
    // Without a team of one worker there is nothing to compare with.
    const Result* one = workers == 0 || least_workers > 1 ? nullptr : &results[1 - least_workers];
    const auto faster = [one](auto figure) {
      return one == nullptr ? std::string("-") : fmt::format("{:.2f}", figure(*one));
    };
    std::printf(
        "| %zu | %zu of %zu | %zu | %.1f | %s | %.1f | %.1f | %.1f | %s | %s | %s | %.1f | %.1f "
        "|\n",
        workers, result.found, starts, result.wall_ms.size(), median(result.whole_map_ms),
        faster([&](const Result& r) {
          return median(r.whole_map_ms) / median(result.whole_map_ms);
        }).c_str(),
        median(result.wall_ms), mean(result.wall_ms),
        *std::max_element(result.wall_ms.begin(), result.wall_ms.end()),
        faster([&](const Result& r) { return median(r.wall_ms) / median(result.wall_ms); }).c_str(),
        faster([&](const Result& r) { return mean(r.wall_ms) / mean(result.wall_ms); }).c_str(),
        faster([&](const Result& r) { return cpu_ms(r, 1) / cpu_ms(result, workers); }).c_str(),
        1e3 * result.cpu_s / count, 1e3 * result.workers_s / count);
  }
}

// The teams take turns, so that other load on the machine affects them alike.
void run(const LostOptions& options) {
  const pipeline::Config config;
  const auto map = make_map(options, config);
  const auto drives = drives_of(options, stops_of(options, config));
  std::printf("map of %zu stops; %zu starts of %zu stops, %zu rounds\n", map->maps.size(),
              options.starts, options.stops, options.rounds);
  std::list<Team> teams;
  for (std::size_t workers = options.least_workers; workers <= options.most_workers; ++workers) {
    teams.emplace_back(options, workers, config, map);
  }
  std::vector<Result> results(teams.size());
  for (std::size_t round = 0; round <= options.rounds; ++round) {
    std::optional<Result> first;  // seeds of matches go on from round to round
    std::size_t i = 0;
    for (Team& team : teams) {
      const Result result = team.search(options, drives);
      if (!first) first = result;
      if (!same(*first, result)) throw std::runtime_error("other poses with other workers");
      if (round > 0) append(results[i], result);  // in the first round workers request missing maps
      ++i;
    }
  }
  print(results, options.least_workers, options.starts * options.rounds);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{"how fast a lost robot searches a large map"};
  LostOptions options;
  app.add_option("--path", options.path_m, "metres of the drive that makes the map")
      ->capture_default_str()
      ->check(command_line::range(50.0, 20'000.0));
  app.add_option("--blocks", options.blocks, "of the floor along each side")
      ->capture_default_str()
      ->check(command_line::range(1, 40));
  app.add_option("--starts", options.starts, "places at which the robot is lost")
      ->capture_default_str()
      ->check(command_line::range(1, 1000));
  app.add_option("--stops", options.stops, "that it drives from each of them")
      ->capture_default_str()
      ->check(command_line::range(1, 100));
  app.add_option("--least-workers", options.least_workers, "of the first row")
      ->capture_default_str()
      ->check(command_line::range(0, 64));
  app.add_option("--workers", options.most_workers, "of the last row")
      ->capture_default_str()
      ->check(command_line::range(0, 64));
  app.add_option("--rounds", options.rounds, "through all starts, after one to warm up")
      ->capture_default_str()
      ->check(command_line::range(1, 100));
  app.add_option("--scheduling", options.scheduling, "of the workers' searches, as of ga_worker");
  app.add_option("--map", options.map, "map.pb of the floor: read, or written if it is not there");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_lost_robot: %s\n", error.what());
    return 1;
  }
  return 0;
}
