// The search pool under load: many worker processes and several robots that want different things.
//
//   topogeo_pool_load [--workers W] [--robots R] [--cost-us C] [--seconds S] [--per-process N]
//                     [--lead-seconds T] [--server]
//
// Every worker is a process with a participant of its own (unless N share one), whose search is
// stubbed: a right answer after a fixed time. Every robot is also a process and handles tasks like
// a localizer: it checks every answer and searches a share of them again. The first robot floods
// the pool with batches of 1,000 tasks, the others request a dozen at a time, like the steps of a
// drive. All have a partition of their own and begin together. With --server they find each other
// by a discovery server, which deploy/SCALING.md recommends for more than 16 participants:
// multicast discovery of 68 leaves two cores no time for tasks.
//
// Prints a row for each robot and the number of tasks of each worker. A lost task would be sent
// again ("resent") or searched by the robot ("here"), and every batch is counted. Exits with 1 when
// a task had no answer or a worker no task.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "topogeo/command_line/command_line.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/status.h"
#include "topogeo/supervision/child_process.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "pool_peers.hpp"
#include "sample_quantile.hpp"
#include "stub_workers.hpp"

namespace {

using namespace topogeo;
using bench::Clock;

struct LoadOptions {
  std::size_t workers = 64;
  std::size_t robots = 4;
  std::size_t cost_us = 5000;
  double seconds = 10.0;
  std::size_t per_process = 1;
  double lead_s = 20.0;
  bool server = false;
  std::uint32_t domain = 0;  // 0: any
  bool is_robot = false;
  bool floods = false;
};

/// All wait until this second of the steady clock, which the processes of a host share.
void wait_for_start(double start_s) {
  const Clock::time_point start{
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(start_s))};
  std::this_thread::sleep_until(start);  // all processes begin at the same moment
}

/// A robot; prints its row.
int run_robot(const LoadOptions& options, double start_s) {
  bench::TaskSource source(bench::maps_of_floor());
  bench::PoolClient client(source.maps(), true, options.domain);
  if (client.pool().wait_for_workers(options.workers, bench::kPatience) < options.workers) {
    std::printf("robot: %zu of %zu workers came\n", client.pool().workers(), options.workers);
    return 1;
  }
  // Warm-up: every worker passes the comparisons that a new worker has to.
  for (int i = 0; i < 2; ++i)
    client.pool().match(source.next(4 * options.workers, bench::kStubTasks));
  wait_for_start(start_s);
  const search_pool::BoardCounts before = client.pool().counts();
  const double cpu_s = support::process_cpu_s();
  const Clock::time_point start = Clock::now();
  const std::size_t batch = options.floods ? 1000 : 12;
  std::size_t asked = 0;
  std::size_t answered = 0;
  std::vector<double> batch_ms;
  while (bench::seconds_since(start) < options.seconds) {
    const Clock::time_point begin = Clock::now();
    const auto tasks = source.next(batch, bench::kStubTasks);
    asked += tasks.size();
    answered += client.pool().match(tasks).size();
    batch_ms.push_back(1e3 * bench::seconds_since(begin));
  }
  const double wall_s = bench::seconds_since(start);
  const search_pool::BoardCounts& after = client.pool().counts();
  std::printf("| %s | %zu | %.0f | %zu | %llu | %llu | %.1f | %.1f | %.0f |\n",
              options.floods ? "floods" : "asks for 12", answered,
              static_cast<double>(answered) / wall_s, asked - answered,
              static_cast<unsigned long long>(after.resent - before.resent),
              static_cast<unsigned long long>(after.in_process - before.in_process),
              bench::sample_quantile(batch_ms, 0.5), bench::sample_quantile(batch_ms, 0.99),
              1e6 * (support::process_cpu_s() - cpu_s) / static_cast<double>(answered));
  if (!client.fault().empty()) std::printf("fault: %s\n", client.fault().c_str());
  return answered == asked && client.fault().empty() ? 0 : 1;
}

/// Number of tasks done, as each worker reports it.
class DoneByWorker {
 public:
  explicit DoneByWorker(std::uint32_t domain)
      : participant_([&] {
          messaging::ParticipantOptions options;
          options.domain = domain;
          options.partition = messaging::kAnyPartition;
          options.name = "load";
          options.identity = "status";
          return options;
        }()),
        statuses_(participant_) {
    loop_.add<msg::WorkerStatus>(statuses_, [this](const msg::WorkerStatus& status, const auto&) {
      done_[status.worker_id().to_string()] = status.tasks_done();
    });
  }
  void run_for(std::chrono::milliseconds time) { static_cast<void>(loop_.run_for(time)); }
  [[nodiscard]] std::size_t workers() const { return done_.size(); }
  [[nodiscard]] const std::map<std::string, std::uint64_t>& done() const { return done_; }

 private:
  messaging::Participant participant_;
  messaging::EventLoop loop_;
  messaging::Reader<msg::WorkerStatus> statuses_;
  std::map<std::string, std::uint64_t> done_;
};

/// A discovery server on this host for all participants created from here on.
supervision::ChildProcess start_server() {
  constexpr const char* kPort = "11811";
  if (::setenv("ROS_DISCOVERY_SERVER", (std::string("127.0.0.1:") + kPort).c_str(), 1) != 0) {
    throw std::runtime_error("the environment cannot be set");
  }
  return {"discovery server", "/usr/bin/fast-discovery-server",
          std::vector<std::string>{"-i", "0", "-l", "127.0.0.1", "-p", kPort}, "/dev/null"};
}

/// True when every robot had all its answers and every worker some tasks.
bool run_all(const LoadOptions& options) {
  std::optional<supervision::ChildProcess> server;
  if (options.server) server.emplace(start_server());
  const std::uint32_t domain = options.domain == 0 ? bench::random_domain() : options.domain;
  DoneByWorker done(domain);
  bench::Workers workers;
  const auto flags = bench::flags_of(domain, messaging::kAnyPartition);
  for (std::size_t left = options.workers; left > 0;) {
    const std::size_t count = std::min(left, options.per_process);
    workers.start_stubs(flags, count, std::chrono::microseconds(options.cost_us));
    left -= count;
  }
  const Clock::time_point end = Clock::now() + bench::kPatience;
  while (done.workers() < options.workers && Clock::now() < end) {
    done.run_for(std::chrono::milliseconds(100));
  }
  const std::filesystem::path out =
      std::filesystem::temp_directory_path() / ("load-" + std::to_string(domain));
  std::filesystem::create_directories(out);
  // Robots start once all of them should know all workers.
  const double start_s =
      std::chrono::duration<double>(Clock::now().time_since_epoch()).count() + options.lead_s;
  std::vector<supervision::ChildProcess> robots;
  for (std::size_t i = 0; i < options.robots; ++i) {
    robots.emplace_back(
        "robot", std::filesystem::read_symlink("/proc/self/exe"),
        std::vector<std::string>{"--be-robot", "--domain", std::to_string(domain), "--workers",
                                 std::to_string(options.workers), "--seconds",
                                 std::to_string(options.seconds), "--start-s",
                                 std::to_string(start_s), i == 0 ? "--floods" : "--modest"},
        out / ("robot" + std::to_string(i)));
  }
  std::map<std::string, std::uint64_t> before;
  double before_cpu_s = 0.0;
  bool begun = false;
  const auto workers_cpu_s = [&] {
    double sum = 0.0;
    for (std::size_t i = 0; i < workers.size(); ++i) sum += workers.cpu_s(i);
    return sum;
  };
  for (supervision::ChildProcess& robot : robots) {
    while (!robot.poll()) {
      done.run_for(std::chrono::milliseconds(50));
      const double now_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
      if (begun || now_s < start_s) continue;
      begun = true;
      before = done.done();
      before_cpu_s = workers_cpu_s();
    }
  }
  const double cpu_s = workers_cpu_s() - before_cpu_s;
  done.run_for(std::chrono::milliseconds(1100));  // two statuses
  std::printf(
      "| robot | tasks answered | tasks/s | not answered | resent | here | ms a batch, median | "
      "p99 | CPU us a task |\n|---|---|---|---|---|---|---|---|---|\n");
  for (std::size_t i = 0; i < robots.size(); ++i) {
    std::ifstream file(out / ("robot" + std::to_string(i)));
    for (std::string line; std::getline(file, line);) std::printf("%s\n", line.c_str());
  }
  bool all_well = std::ranges::all_of(
      robots, [](supervision::ChildProcess& robot) { return robot.poll()->clean(); });
  std::vector<double> each;
  double sum = 0.0;
  for (const auto& [id, count] : done.done()) {
    all_well = all_well && count > 0;
    each.push_back(static_cast<double>(count - before[id]));
    sum += each.back();
  }
  std::printf("%zu workers: %.0f tasks, %.0f each, fewest %.0f, most %.0f; CPU us a task: %.0f\n",
              each.size(), sum, sum / static_cast<double>(each.size()),
              *std::min_element(each.begin(), each.end()),
              *std::max_element(each.begin(), each.end()), 1e6 * cpu_s / sum);
  std::filesystem::remove_all(out);
  if (server) server->send_signal(SIGTERM);
  return all_well && each.size() == options.workers;
}

}  // namespace

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (std::any_of(words.begin(), words.end(),
                  [](std::string_view word) { return word == "--stub-workers"; })) {
    return bench::run_stub_workers(argc, argv);
  }
  command_line::Command app{"the search pool under load"};
  LoadOptions options;
  double start_s = 0.0;
  bool modest = false;
  app.add_option("--workers", options.workers, "search workers whose search is stubbed")
      ->capture_default_str()
      ->check(command_line::range(1, 1000));
  app.add_option("--robots", options.robots, "the first floods the pool")
      ->capture_default_str()
      ->check(command_line::range(1, 100));
  app.add_option("--cost-us", options.cost_us, "of a search")
      ->capture_default_str()
      ->check(command_line::range(0, 1'000'000));
  app.add_option("--seconds", options.seconds, "how long robots ask")
      ->capture_default_str()
      ->check(command_line::range(1.0, 3600.0));
  app.add_option("--lead-seconds", options.lead_s, "until robots ask, for all to know each other")
      ->capture_default_str()
      ->check(command_line::range(0.0, 600.0));
  app.add_option("--per-process", options.per_process, "workers in a process")
      ->capture_default_str()
      ->check(command_line::range(1, 64));
  app.add_flag("--server", options.server, "discovery by a server (package fastdds-tools)");
  app.add_option("--domain", options.domain, "of DDS; 0: any")->check(command_line::range(0, 232));
  app.add_flag("--be-robot", options.is_robot, "on that domain");
  app.add_option("--start-s", start_s, "of a robot: when to begin, s of the steady clock");
  app.add_flag("--floods", options.floods, "of a robot");
  app.add_flag("--modest", modest, "of a robot");
  if (const auto exit_code = app.parse_or_report(argc, argv)) return *exit_code;
  try {
    if (options.is_robot) return run_robot(options, start_s);
    return run_all(options) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topogeo_pool_load: %s\n", error.what());
    return 1;
  }
}
