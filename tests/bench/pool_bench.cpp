// Cost and gain of the search pool. Everything is real (client, DDS, other processes) but for the
// searches of dispatch/64; no other program may run meanwhile, and two cores are needed.
//
// dispatch/64         tasks through 64 workers in 8 processes that answer without searching. Each
//                     worker has readers and writers of its own; a process shares one participant,
//                     because 64 participants on two cores would measure the scheduler. The
//                     client does all that a localizer's does, checks and audits included.
// dispatch/64_bare    the same without the checks of answers.
// pool/2              1,000 tasks of 100 individuals and 50 generations with two real workers;
//                     `speed_up` against one with the same tasks, median of nine pairs.
//                     pool/2_50x30: the default parameters. On two cores the client and the
//                     middleware run at the expense of the workers; pool/2_200x100 shows how much
//                     this matters with longer searches. `*_cpu_us`: CPU time for each task, all
//                     threads of the processes; a worker's includes the other team's batches.
// message/K           messages of K times 600 bytes, the size of a task, between two participants
//                     of this process: CPU time of both for each 600 bytes. It shows how much
//                     batches would save of the cost of a task.
// board/W             the client's bookkeeping alone: a task to one of W workers and its answer.
// pool/latency        one task at a time: median of the time through a pool of one real worker
//                     minus that of the same search in this process, all maps known everywhere.
// pool/late_map       from the moment that the client knows a worker that has just been started to
//                     the answer to a task on maps that were sent before, minus the search.
// pool/late_map_asked the same with maps that were never sent, so that the worker has to ask.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/store.h"
#include "topogeo/search_pool/task_board.hpp"
#include "topogeo/support/cpu_time.hpp"

#include "pool_peers.hpp"
#include "stub_workers.hpp"

namespace topogeo::bench {
namespace {

using localization::MatchTask;

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Times of a batch.
struct Cost {
  double wall_s = 0.0;
  double cpu_s = 0.0;  // of this process
};

Cost cost_of(PoolClient& client, const std::vector<MatchTask>& tasks) {
  const double cpu_s = support::process_cpu_s();
  const Clock::time_point start = Clock::now();
  benchmark::DoNotOptimize(client.pool().match(tasks));
  return {seconds_since(start), support::process_cpu_s() - cpu_s};
}

/// A benchmark with a fault measures something else.
void check(benchmark::State& state, const PoolClient& client) {
  if (!client.fault().empty()) state.SkipWithError(client.fault().c_str());
}

/// Waits until there are `count` workers that can be used.
bool have_workers(benchmark::State& state, PoolClient& client, std::size_t count) {
  if (client.pool().wait_for_workers(count, kPatience) == count) return true;
  state.SkipWithError(("the workers did not come; " + client.fault()).c_str());
  return false;
}

void dispatch(benchmark::State& state, bool verify) {
  constexpr std::size_t kProcesses = 8;
  constexpr std::size_t kWorkers = 64;
  constexpr std::size_t kBatch = 1000;
  TaskSource source(maps_of_floor());
  PoolClient client(source.maps(), verify);
  Workers workers;
  for (std::size_t i = 0; i < kProcesses; ++i)
    workers.start_stubs(client.flags(), kWorkers / kProcesses);
  if (!have_workers(state, client, kWorkers)) return;
  // Warm-up: every worker passes the comparisons that a new worker has to.
  for (int i = 0; i < 2; ++i) cost_of(client, source.next(kBatch, kStubTasks));

  const std::uint64_t resent = client.pool().counts().resent;
  Cost total;
  for (auto _ : state) {
    const Cost cost = cost_of(client, source.next(kBatch, kStubTasks));
    state.SetIterationTime(cost.wall_s);
    total.wall_s += cost.wall_s;
    total.cpu_s += cost.cpu_s;
  }
  const double tasks = static_cast<double>(state.iterations()) * kBatch;
  state.counters["tasks_per_s"] = tasks / total.wall_s;
  state.counters["client_cpu_us"] = 1e6 * total.cpu_s / tasks;
  state.counters["resent"] = static_cast<double>(client.pool().counts().resent - resent);
  check(state, client);
}

/// A client, whose maps are published, and its workers.
struct Team {
  explicit Team(const localization::test::Maps& maps) : client(maps) { client.publish(maps); }

  bool has_workers(benchmark::State& state, std::size_t count) {
    while (workers.size() < count) workers.start_real(client);
    return have_workers(state, client, count);
  }
  [[nodiscard]] double workers_cpu_s() const {
    double sum_s = 0.0;
    for (std::size_t i = 0; i < workers.size(); ++i) sum_s += workers.cpu_s(i);
    return sum_s;
  }

  PoolClient client;
  Workers workers;
};

void speed_up(benchmark::State& state, std::uint32_t individuals, std::uint32_t generations) {
  constexpr std::size_t kBatch = 1000;
  constexpr int kPairs = 9;
  TaskSource source(maps_of_floor());
  Team one(source.maps());
  Team two(source.maps());
  if (!one.has_workers(state, 1) || !two.has_workers(state, 2)) return;
  const auto batch = [&] {
    std::vector<MatchTask> tasks = source.next(kBatch);
    for (MatchTask& task : tasks) {
      task.genetic.individuals = individuals;
      task.genetic.generations = generations;
    }
    return tasks;
  };
  const std::vector<MatchTask> first = batch();
  for (Team* team : {&one, &two}) cost_of(team->client, first);  // makes the features of the maps

  // In turn, so that a change of the machine's speed affects both alike.
  std::vector<double> ratios;
  std::vector<double> by_two_s;
  double client_cpu_s = 0.0;
  const double one_before_s = one.workers_cpu_s();
  const double two_before_s = two.workers_cpu_s();
  for (auto _ : state) {
    for (int i = 0; i < kPairs; ++i) {
      const std::vector<MatchTask> tasks = batch();
      Cost by_one = i % 2 == 0 ? cost_of(one.client, tasks) : Cost();
      const Cost by_two = cost_of(two.client, tasks);
      if (i % 2 != 0) by_one = cost_of(one.client, tasks);
      by_two_s.push_back(by_two.wall_s);
      ratios.push_back(by_one.wall_s / by_two.wall_s);
      client_cpu_s += by_two.cpu_s;
    }
    state.SetIterationTime(median(by_two_s));
  }
  const double us_a_task = 1e6 / (kBatch * kPairs);
  state.counters["speed_up"] = median(ratios);
  state.counters["tasks_per_s"] = kBatch / median(by_two_s);
  state.counters["client_cpu_us"] = us_a_task * client_cpu_s;
  state.counters["worker_cpu_us"] = us_a_task * (two.workers_cpu_s() - two_before_s);
  state.counters["worker_alone_cpu_us"] = us_a_task * (one.workers_cpu_s() - one_before_s);
  for (Team* team : {&one, &two}) check(state, team->client);
}

void message(benchmark::State& state, std::size_t tasks_in_message) {
  constexpr std::size_t kTaskBytes = 600;
  constexpr std::size_t kTasks = 2048;
  messaging::ParticipantOptions options;
  options.domain = random_domain();
  options.partition = "message";
  options.name = "bench";
  options.identity = "map_store";
  const messaging::Participant from(options);
  options.identity = "localizer";
  const messaging::Participant to(options);
  messaging::EventLoop loop;
  messaging::Writer<msg::SnapshotPiece> writer(from);
  messaging::Reader<msg::SnapshotPiece> reader(to);
  std::size_t came = 0;
  loop.add<msg::SnapshotPiece>(reader, [&](const msg::SnapshotPiece& piece, const auto&) {
    came += piece.bytes().size() / kTaskBytes;
    loop.stop();
  });
  while (writer.matched() == 0) static_cast<void>(loop.run_for(std::chrono::milliseconds(5)));
  msg::SnapshotPiece piece;
  messaging::set_header(piece, "robot", 0, 0);
  messaging::set_client_id(piece, "bench");
  piece.bytes().assign(kTaskBytes * tasks_in_message, std::uint8_t{1});
  double cpu_s = 0.0;
  for (auto _ : state) {
    const double before_s = support::process_cpu_s();
    came = 0;
    for (std::size_t sent = 0; sent < kTasks; sent += tasks_in_message) {
      if (!writer.write(piece)) state.SkipWithError("not sent");
      // The pool behaves alike: few tasks are under way to a worker.
      while (came <= sent) static_cast<void>(loop.run_for(std::chrono::seconds(1)));
    }
    const double used_s = support::process_cpu_s() - before_s;
    cpu_s += used_s;
    state.SetIterationTime(used_s);
  }
  state.counters["cpu_us_a_task"] =
      1e6 * cpu_s / static_cast<double>(kTasks * static_cast<std::size_t>(state.iterations()));
}

void board(benchmark::State& state, std::size_t workers) {
  constexpr std::size_t kBatch = 1000;
  search_pool::BoardConfig config;
  config.probation = 0;
  config.audit_every = 0;
  search_pool::TaskBoard board(config);
  search_pool::BoardTime now{0};
  std::uint64_t next_id = 0;
  for (std::size_t i = 0; i < workers; ++i) {
    const std::string id = "worker#" + std::to_string(i);
    board.worker_up(id, 1, now);
    board.set_reachable(id, true);
  }
  const double before_s = support::process_cpu_s();
  for (auto _ : state) {
    std::vector<MatchTask> tasks(kBatch);
    for (MatchTask& task : tasks) task.task_id = next_id++;
    board.begin(tasks);
    std::deque<search_pool::TaskBoard::Assignment> out;
    while (!board.done()) {
      now += std::chrono::microseconds(100);
      while (auto assignment = board.next_remote(now)) out.push_back(*assignment);
      localization::MatchResult result;
      result.task_id = board.task(out.front().task).task_id;
      board.answer(out.front().worker_id, std::move(result), now);
      out.pop_front();
    }
    benchmark::DoNotOptimize(board.take_results());
  }
  state.counters["cpu_us_a_task"] = 1e6 * (support::process_cpu_s() - before_s) /
                                    static_cast<double>(state.iterations()) / kBatch;
}

void latency(benchmark::State& state) {
  constexpr int kTasks = 300;
  TaskSource source(maps_of_floor());
  PoolClient client(source.maps());
  client.publish(source.maps());
  Workers workers;
  workers.start_real(client);
  if (!have_workers(state, client, 1)) return;
  localization::Matcher matcher;
  for (const auto& map : source.maps()) matcher.add_map(*map);
  MatchTask task = source.next(1).front();
  std::vector<double> through_pool_s;
  std::vector<double> added_s;
  for (auto _ : state) {
    for (int i = 0; i < kTasks; ++i) {
      ++task.task_id;
      ++task.seed;
      const double pool_s = cost_of(client, {task}).wall_s;
      const Clock::time_point start = Clock::now();
      benchmark::DoNotOptimize(matcher.solve(task));
      if (i < kTasks / 10) continue;  // warm-up
      through_pool_s.push_back(pool_s);
      added_s.push_back(pool_s - seconds_since(start));
    }
    state.SetIterationTime(median(added_s));
  }
  state.counters["through_pool_us"] = 1e6 * median(through_pool_s);
  check(state, client);
}

void late_map(benchmark::State& state, bool sent_before) {
  TaskSource source(maps_of_floor());
  localization::Matcher matcher;
  for (const auto& map : source.maps()) matcher.add_map(*map);
  std::vector<double> known_s;
  std::vector<double> answered_s;
  for (auto _ : state) {
    PoolClient client(source.maps());
    if (sent_before) client.publish(source.maps());
    const std::vector<MatchTask> tasks = source.next(1);
    Workers workers;
    const Clock::time_point start = Clock::now();
    workers.start_real(client);
    if (!have_workers(state, client, 1)) return;
    known_s.push_back(seconds_since(start));
    const double through_pool_s = cost_of(client, tasks).wall_s;
    const Clock::time_point search = Clock::now();
    benchmark::DoNotOptimize(matcher.solve(tasks.front()));
    answered_s.push_back(std::max(0.0, through_pool_s - seconds_since(search)));
    state.SetIterationTime(answered_s.back());
    check(state, client);
    if (client.pool().counts().in_process > 0) state.SkipWithError("the worker did not answer");
  }
  state.counters["median_s"] = median(answered_s);
  state.counters["known_after_s"] = median(known_s);
}

void register_all() {
  constexpr int kBatches = 5;
  constexpr int kStarts = 5;
  const auto add = [](const char* name, auto function, auto... arguments) {
    return benchmark::RegisterBenchmark(name, function, arguments...)
        ->UseManualTime()
        ->Unit(benchmark::kMillisecond);
  };
  add("dispatch/64", dispatch, true)->Iterations(kBatches);
  add("dispatch/64_bare", dispatch, false)->Iterations(kBatches);
  add("pool/2", speed_up, 100, 50)->Iterations(1);
  add("pool/2_50x30", speed_up, 50, 30)->Iterations(1);
  add("pool/2_200x100", speed_up, 200, 100)->Iterations(1);
  for (const std::size_t tasks : {1, 2, 4, 8, 16, 32}) {
    add(("message/" + std::to_string(tasks)).c_str(), message, tasks)->Iterations(3);
  }
  for (const std::size_t workers : {64, 256, 1000}) {
    benchmark::RegisterBenchmark(("board/" + std::to_string(workers)).c_str(), board, workers)
        ->Unit(benchmark::kMillisecond);
  }
  add("pool/latency", latency)->Iterations(1);
  add("pool/late_map", late_map, true)->Iterations(kStarts);
  add("pool/late_map_asked", late_map, false)->Iterations(kStarts);
}

}  // namespace
}  // namespace topogeo::bench

int main(int argc, char** argv) {
  const std::span<char*> words(argv, static_cast<std::size_t>(argc));
  if (std::any_of(words.begin(), words.end(),
                  [](std::string_view word) { return word == "--stub-workers"; })) {
    return topogeo::bench::run_stub_workers(argc, argv);
  }
  topogeo::bench::register_all();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
