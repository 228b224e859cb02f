// Maps drives through synthetic floors, some seeds of each, and prints the errors against the
// truth, the closed loops and the false ones; synthetic.sh prints its table.
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <numbers>
#include <thread>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/support/atomic_file.hpp"

#include "synthetic_run.hpp"

namespace {

using namespace topogeo;
using bench::SyntheticResult;

constexpr double kDegree = std::numbers::pi / 180.0;

struct SyntheticOptions {
  std::vector<std::string> worlds;
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 20;
  std::size_t jobs = 1;
  std::string config_file;
  std::string save;
  bool hand_held = false;
  bool markdown = false;
};

std::string file_name(const bench::SyntheticFloor& floor, std::uint64_t seed) {
  std::string name = floor.name + "-" + std::to_string(seed);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

void tell(const std::string& floor, const SyntheticResult& r) {
  std::fprintf(stderr,
               "%s %2llu: rms %.3f m (from start %.3f, largest %.3f, odometry %.2f), heading %.2f "
               "deg, step %.4f m %.3f deg, scale %+.4f (odometry %+.4f), loops %zu/%zu, pieces "
               "%zu/%zu, closures "
               "%zu, false %zu, %zu stops, %.0f m, %.1f s\n",
               floor.c_str(), static_cast<unsigned long long>(r.seed), r.rms_m, r.rms_from_start_m,
               r.largest_m, r.odometry_rms_m, r.heading_rad / kDegree, r.local_m,
               r.local_rad / kDegree, r.scale, r.odometry_scale, r.loops_closed, r.loops,
               r.pieces_closed, r.pieces, r.closures, r.false_loops.size(), r.stops, r.path_m,
               r.cpu_s);
  for (const bench::FalseLoop& loop : r.false_loops) {
    std::fprintf(stderr, "    false loop %u - %u: off by %.2f m %.1f deg, places %.1f m apart\n",
                 loop.earlier_id, loop.later_id, loop.off_m, loop.off_rad / kDegree, loop.apart_m);
  }
}

// Runs all seeds of one floor, `jobs` at a time; results in the order of the seeds.
std::vector<SyntheticResult> run_floor(const bench::SyntheticFloor& floor,
                                       const SyntheticOptions& options,
                                       const pipeline::Config& config) {
  std::vector<SyntheticResult> results(options.seeds);
  std::atomic<std::uint64_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::uint64_t i = next++; i < options.seeds; i = next++) {
      try {
        const std::uint64_t seed = options.first_seed + i;
        const simulation::SimulatedLog log = options.hand_held
                                                 ? bench::hand_held_drive(floor.draw(seed), seed)
                                                 : bench::synthetic_drive(floor.draw(seed), seed);
        if (!options.save.empty()) bench::save_log(log, options.save, file_name(floor, seed));
        results[i] = bench::run_synthetic(log, config);
        results[i].seed = seed;
        const std::scoped_lock lock(mutex);
        tell(floor.name, results[i]);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        failure = std::current_exception();
        return;
      }
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < options.jobs; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  return results;
}

constexpr const char* kSyntheticHeader =
    "| floor | runs | m a run | odometry rms m | rms m, mean | rms m, worst | runs above 0.05 m | "
    "rms m from the first pose, mean | worst | heading deg, mean | worst | loops closed | of "
    "returns, pieces of 10 m with a closure | closures | false | runs with a false one | CPU s a "
    "run |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";

void print(const std::string& name, const std::vector<SyntheticResult>& runs, bool markdown) {
  const auto mean = [&](auto field) {
    double sum = 0.0;
    for (const SyntheticResult& run : runs) sum += field(run);
    return sum / static_cast<double>(runs.size());
  };
  const auto worst = [&](auto field) {
    double most = 0.0;
    for (const SyntheticResult& run : runs) most = std::max(most, field(run));
    return most;
  };
  const auto count = [&](auto field) {
    std::size_t sum = 0;
    for (const SyntheticResult& run : runs) sum += field(run);
    return sum;
  };
  const auto rms_m = [](const SyntheticResult& r) { return r.rms_m; };
  const auto start_m = [](const SyntheticResult& r) { return r.rms_from_start_m; };
  const auto heading_deg = [](const SyntheticResult& r) { return r.heading_rad / kDegree; };
  const char* form =
      markdown
          ? "| %s | %zu | %.0f | %.2f | %.3f | %.3f | %zu | %.3f | %.3f | %.2f | %.2f | %zu of "
            "%zu | %zu of %zu | %zu | %zu | %zu | %.1f |\n"
          : "%-24s runs %zu, %.0f m; odometry %.2f m; rms %.3f worst %.3f m, %zu above 0.05; "
            "from start %.3f worst %.3f m; heading %.2f worst %.2f deg; loops %zu of %zu, "
            "pieces %zu of %zu; closures %zu, false %zu in %zu runs; %.1f s CPU\n";
  std::printf(form, name.c_str(), runs.size(), mean([](const auto& r) { return r.path_m; }),
              mean([](const auto& r) { return r.odometry_rms_m; }), mean(rms_m), worst(rms_m),
              count([](const auto& r) { return r.rms_m > 0.05 ? 1U : 0U; }), mean(start_m),
              worst(start_m), mean(heading_deg), worst(heading_deg),
              count([](const auto& r) { return r.loops_closed; }),
              count([](const auto& r) { return r.loops; }),
              count([](const auto& r) { return r.pieces_closed; }),
              count([](const auto& r) { return r.pieces; }),
              count([](const auto& r) { return r.closures; }),
              count([](const auto& r) { return r.false_loops.size(); }),
              count([](const auto& r) { return r.false_loops.empty() ? 0U : 1U; }),
              mean([](const auto& r) { return r.cpu_s; }));
  std::fflush(stdout);
}

void run(const SyntheticOptions& options) {
  const pipeline::Config config =
      pipeline::load_config(options.config_file.empty()
                                ? std::nullopt
                                : std::optional<std::filesystem::path>(options.config_file))
          .config;
  if (!options.save.empty()) support::check_writable_directory(options.save);
  if (options.markdown) std::fputs(kSyntheticHeader, stdout);
  std::vector<SyntheticResult> all;
  for (const bench::SyntheticFloor& floor : bench::synthetic_floors()) {
    const auto& wanted = options.worlds;
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), floor.name) == wanted.end()) {
      continue;
    }
    if (options.hand_held && floor.large) continue;
    const std::vector<SyntheticResult> runs = run_floor(floor, options, config);
    print(floor.name, runs, options.markdown);
    all.insert(all.end(), runs.begin(), runs.end());
  }
  print("all", all, options.markdown);
}

}  // namespace

int main(int argc, char** argv) {
  command_line::Command app{
      "how far maps of synthetic floors are from the truth; each run on standard error"};
  SyntheticOptions options;
  std::vector<std::string> names;
  for (const auto& floor : bench::synthetic_floors()) names.push_back(floor.name);
  app.add_option("--worlds", options.worlds, "floors by name, separated by commas; default all")
      ->delimiter(',')
      ->check(command_line::one_of(names));
  app.add_option("--seeds", options.seeds, "runs of each floor")
      ->capture_default_str()
      ->check(command_line::range(1, 10'000));
  app.add_option("--first-seed", options.first_seed, "seed of the first run")
      ->capture_default_str();
  app.add_option("--jobs", options.jobs, "runs at a time")
      ->capture_default_str()
      ->check(command_line::range(1, 2));
  app.add_option("--config", options.config_file, "configuration file")
      ->check(command_line::existing_file());
  app.add_option("--save", options.save, "write each log with its true poses into this folder");
  app.add_flag("--hand-held", options.hand_held,
               "a hand-held laser without odometry; not through the largest floors");
  app.add_flag("--markdown", options.markdown, "print a table in Markdown");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    run(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_synthetic: %s\n", error.what());
    return 1;
  }
  return 0;
}
