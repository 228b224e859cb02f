// Local maps of a simulated drive, tasks on them, and peers of the search pool in a partition of
// the test's own.
#pragma once

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/pipeline/local_mapper.hpp"
#include "topogeo/search_pool/task_board.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/simulation/simulate_log.hpp"
#include "topogeo/support/version.hpp"
#include "topogeo/world/world.hpp"

#include "program.hpp"
#include "remote_pool.hpp"
#include "waiting.hpp"

namespace topogeo::test {

using Maps = std::vector<std::shared_ptr<const topomap::LocalMap>>;

inline Maps maps_of_room() {
  const world::World world =
      world::load_world(std::string(TOPOGEO_SHARE) + "/worlds/room.world.yaml");
  pipeline::LocalMapper mapper({}, "robot");
  Maps maps;
  for (const scan::Scan& scan : simulation::simulate_log(world, {}).scans) {
    if (auto map = mapper.add(scan)) {
      maps.push_back(std::make_shared<const topomap::LocalMap>(std::move(*map)));
    }
  }
  return maps;
}

/// Tasks between each map and the ones just before it, repeated until there are `count`.
inline std::vector<localization::MatchTask> tasks_on(const Maps& maps, std::size_t count,
                                                     std::uint64_t first_id = 0) {
  std::vector<localization::MatchTask> tasks;
  for (std::size_t i = 0; tasks.size() < count; ++i) {
    const topomap::LocalMap& query = *maps[1 + i % (maps.size() - 1)];
    const topomap::LocalMap& reference = *maps[query.id - 1 - (i % 3) % query.id];
    localization::MatchTask task;
    task.task_id = first_id + i;
    task.reference_map_id = reference.id;
    task.query_map_id = query.id;
    task.reference_hash = topomap::content_hash(reference);
    task.query_hash = topomap::content_hash(query);
    task.T_reference_query = geometry::between(reference.T_odom_robot, query.T_odom_robot);
    task.covariance = Eigen::Vector3d(0.04, 0.04, 0.01).asDiagonal();
    task.half_width = Eigen::Vector3d(0.5, 0.5, 0.3);
    task.seed = 7 * i + 1;
    tasks.push_back(task);
  }
  return tasks;
}

inline std::string random_partition() {
  std::random_device device;
  return "test-" + std::to_string(device()) + std::to_string(device());
}

/// In the test's own domain: workers of other tests serve every partition of theirs.
inline messaging::ParticipantOptions options_in(const std::string& partition) {
  messaging::ParticipantOptions options;
  options.domain = static_cast<std::uint32_t>(std::stoul(own_domain()));
  options.partition = partition;
  options.name = "test";
  return options;
}

/// A worker in the test's own process that is controlled by the test.
class FakeWorker {
 public:
  using OnTask = std::function<void(FakeWorker&, const msg::MatchTask&)>;
  using Dress = std::function<void(msg::WorkerStatus&)>;

  FakeWorker(const FakeWorker&) = delete;
  FakeWorker& operator=(const FakeWorker&) = delete;
  /// `dress` changes its status, which is otherwise acceptable to any client.
  FakeWorker(const std::string& partition, messaging::EventLoop& loop, const std::string& worker_id,
             const OnTask& on_task, const Dress& dress = {})
      : loop_(loop),
        participant_(options_in(partition)),
        statuses_(participant_),
        results_(participant_),
        requests_(participant_),
        tasks_(participant_, {{}, worker_id}) {
    loop_.add<msg::MatchTasks>(tasks_, [this, on_task](const msg::MatchTasks& tasks, const auto&) {
      client_id_ = tasks.client_id().to_string();
      for (const msg::MatchTask& task : tasks.tasks()) {
        ++received;
        on_task(*this, task);
      }
    });
    messaging::set_header(status_, "", 0, 0);
    messaging::set_worker_id(status_, worker_id);
    messaging::set_text(status_.host(), "here", "host");
    messaging::set_text(status_.version(), support::kVersion, "version");
    status_.matcher_fingerprint(localization::matcher_fingerprint());
    status_.slots(1);
    if (dress) dress(status_);
    begin_to_announce();
  }
  ~FakeWorker() { loop_.cancel_timer(timer_); }

  void begin_to_announce() {
    timer_ = loop_.add_timer(std::chrono::milliseconds(200), [this] { announce(); });
    announce();
  }
  void cease_to_announce() { loop_.cancel_timer(timer_); }
  /// Announces that it leaves, like a worker that drains.
  void leave() {
    cease_to_announce();
    statuses_.dispose(status_);
  }
  /// Publishes the status that `dress` returns from now on.
  void change(const Dress& dress) {
    dress(status_);
    announce();
  }

  void answer(const msg::MatchTask& task, localization::MatchResult result,
              msg::MatchStatus status = msg::kMatchSolved) {
    result.task_id = task.task_id();
    service::MatchAddress address;
    address.robot_id = "robot";
    address.worker_id = status_.worker_id().to_string();
    address.client_id = client_id_;
    msg::MatchResults message = service::results_for(address);
    message.results().push_back(service::to_msg(result));
    message.results().front().status(status);
    EXPECT_TRUE(wait_by("a reader of results",
                        [&](auto at_most) { return results_.wait_for_matched(1, at_most); }));
    EXPECT_TRUE(results_.write(message));
  }
  void request_map(std::uint32_t map_id, std::uint64_t hash) {
    msg::MapRequest request;
    messaging::set_header(request, "robot", 0, 0);
    messaging::set_client_id(request, client_id_);
    messaging::set_worker_id(request, status_.worker_id().c_str());
    request.map_id(map_id);
    request.content_hash(hash);
    EXPECT_TRUE(wait_by("a reader of map requests",
                        [&](auto at_most) { return requests_.wait_for_matched(1, at_most); }));
    EXPECT_TRUE(requests_.write(request));
  }

  [[nodiscard]] const messaging::Participant& participant() const { return participant_; }
  /// The client of the last task.
  [[nodiscard]] const std::string& client_id() const { return client_id_; }

  int received = 0;

 private:
  void announce() { EXPECT_TRUE(statuses_.write(status_)); }

  messaging::EventLoop& loop_;
  std::uint64_t timer_ = 0;
  messaging::Participant participant_;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MatchResults> results_;
  messaging::Writer<msg::MapRequest> requests_;
  messaging::Reader<msg::MatchTasks> tasks_;
  msg::WorkerStatus status_;
  std::string client_id_;
};

/// Solves tasks like a worker, or with other search parameters.
class Solver {
 public:
  explicit Solver(const Maps& maps) {
    for (const auto& map : maps) matcher_.add_map(*map);
  }
  localization::MatchResult solve(const msg::MatchTask& task) {
    return matcher_.solve(service::from_msg(task));
  }
  /// A valid result of a search that stopped early.
  localization::MatchResult solve_poorly(const msg::MatchTask& task) {
    localization::MatchTask shorter = service::from_msg(task);
    shorter.genetic.generations = 1;
    return matcher_.solve(shorter);
  }

 private:
  localization::Matcher matcher_;
};

inline bool wait_for_workers(localizer::RemotePool& pool, std::size_t count) {
  return wait_by(std::to_string(count) + " workers",
                 [&](auto at_most) { return pool.wait_for_workers(count, at_most) == count; });
}

/// A pool in the test's process with the local maps of a room.
class PoolTest : public ::testing::Test {
 protected:
  void SetUp() override {
    localizer::RemotePoolOptions options;
    options.robot_id = "robot";
    options.client_id = "client-" + partition_;
    options.client_id.resize(std::min<std::size_t>(options.client_id.size(), 64));
    options.version = support::kVersion;
    options.config_fingerprint = 0x12;
    options.board = board_options_;
    options.log = [this](const std::string& line) { lines_.push_back(line); };
    pool_.emplace(participant_, loop_, options,
                  [this](std::string_view reason, std::string_view detail) {
                    faults_.emplace_back(reason);
                    details_.emplace_back(detail);
                  });
    for (const auto& map : maps_) pool_->add_map(map);
    loop_.add<msg::WorkerStatus>(worker_statuses_, [this](const auto& status, const auto&) {
      maps_held_[status.worker_id().to_string()] = status.maps_held();
    });
  }
  void TearDown() override { workers_.clear(); }

  Program& start_worker(const std::string& name) {
    workers_.push_back(
        std::make_unique<Program>(scratch_, "ga_worker",
                                  std::vector<std::string>{"--domain", own_domain(), "--partition",
                                                           partition_, "--name", name}));
    return *workers_.back();
  }
  void publish_maps() {
    for (const auto& map : maps_) ASSERT_TRUE(map_writer_.write(service::to_msg(*map)));
  }
  /// Waits until all started workers hold the published maps. A worker waits two seconds for a map
  /// that a task names, and then gives the task back.
  bool wait_for_maps() {
    return wait_until("the maps at the workers", [this] {
      const auto holders = std::ranges::count_if(
          maps_held_, [this](const auto& worker) { return worker.second >= maps_.size(); });
      return static_cast<std::size_t>(holders) >= workers_.size();
    });
  }
  /// Repeats `attempt` until no map reaches a worker too late in it, which the time of this process
  /// decides.
  bool wait_for_maps_in_time(const std::function<void()>& attempt) {
    return test::wait_for("an attempt in which all maps come in time", [&] {
      const std::uint64_t missing = pool_->counts().map_missing;
      attempt();
      return HasFailure() || pool_->counts().map_missing == missing;
    });
  }
  /// Ends the last worker, and waits until the pool has none.
  void end_worker() {
    workers_.back()->send_signal(SIGTERM);
    EXPECT_EQ(workers_.back()->wait(), 0);
    workers_.pop_back();
    EXPECT_TRUE(wait_until("the worker to be gone", [this] { return pool_->workers() == 0; }));
  }
  void expect_same(const std::vector<localization::MatchTask>& tasks,
                   const std::vector<localization::MatchResult>& results) {
    localization::InProcessPool in_process;
    for (const auto& map : maps_) in_process.add_map(map);
    const std::vector<localization::MatchResult> expected = in_process.match(tasks);
    ASSERT_EQ(results.size(), expected.size());
    std::size_t solved = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_TRUE(localization::identical(results[i], expected[i])) << "task " << i;
      if (expected[i].status == localization::MatchStatus::kSolved) ++solved;
    }
    EXPECT_GT(solved, expected.size() / 2) << "the tasks are not worth comparing";
  }
  /// Runs `action` once so many tasks are sent, during match().
  void when_sent(std::uint64_t count, std::function<void()> action) {
    when([this, count] { return pool_->counts().sent >= count; }, std::move(action));
  }
  /// Runs `action` once a condition holds, during match().
  void when(std::function<bool()> condition, std::function<void()> action) {
    timer_ = loop_.add_timer(std::chrono::milliseconds(1),
                             [this, condition = std::move(condition), action = std::move(action)] {
                               if (!condition()) return;
                               // It is destroyed with its timer, and may set the next one.
                               const std::function<void()> once = action;
                               loop_.cancel_timer(timer_);
                               once();
                             });
  }
  /// Runs the loop outside of match().
  bool wait_until(const std::string& what, const std::function<bool()>& condition) {
    return wait_in_loop(loop_, what, condition);
  }
  bool wait_for_workers(std::size_t count) { return test::wait_for_workers(*pool_, count); }

  // A killed program leaves segments in /dev/shm that others may still wait at.
  const bool udp_only_ = (use_udp_only(), true);
  std::string partition_ = random_partition();
  Scratch scratch_;
  Maps maps_ = maps_of_room();
  messaging::Participant participant_{options_in(partition_)};
  messaging::Writer<msg::LocalMap> map_writer_{participant_};
  messaging::Reader<msg::WorkerStatus> worker_statuses_{participant_};
  messaging::EventLoop loop_;
  search_pool::BoardConfig board_options_ = patient();
  std::vector<std::string> faults_;
  std::vector<std::string> details_;
  std::vector<std::string> lines_;
  std::optional<localizer::RemotePool> pool_;
  std::vector<std::unique_ptr<Program>> workers_;
  std::map<std::string, std::size_t> maps_held_;  // by worker
  std::uint64_t timer_ = 0;

 private:
  /// Never drops a slow worker on a busy machine, unless a test wants it.
  static search_pool::BoardConfig patient() {
    search_pool::BoardConfig options;
    options.straggler_floor = hang_limit();
    return options;
  }
};

}  // namespace topogeo::test
