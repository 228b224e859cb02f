// Distributes match tasks to search workers on the network, and solves them itself when there are
// none (design, the search pool). TaskBoard assigns the tasks, WorkerRegistry admits workers; this
// class carries them over DDS and checks every answer.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/matching/match.hpp"
#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/search_pool/pool_log.hpp"
#include "topogeo/search_pool/task_board.hpp"
#include "topogeo/search_pool/worker_registry.hpp"
#include "topogeo/service/participant_id.hpp"

#include "map_sender.hpp"
#include "worker_writer.hpp"

namespace topogeo::localizer {

/// Thrown out of RemotePool while it waits, because the program must end.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped while waiting for match results") {}
};

struct RemotePoolOptions {
  std::string robot_id;                  ///< 1 to 32 bytes
  std::string client_id;                 ///< 1 to 64 bytes without quotes, unique on the domain
  std::string version;                   ///< workers with another version are not used
  std::uint64_t config_fingerprint = 0;  ///< workers with another one are not used
  search_pool::BoardConfig board;
  /// Recomputes fitness and verdict of every answer. Off only to measure the cost.
  bool verify = true;
  /// Checked after every wait: true when the program must end. Empty: never.
  std::function<bool()> stopping;
  /// Gets lines for the user; empty: they are logged.
  search_pool::PoolLog::Sink log;
};

/// Creates its own readers and writers, because tests and benchmarks have several pools but a
/// process has one service::Service, and because statuses come from workers of every robot, with
/// the process of their writer.
///
/// Everything happens in the thread that calls it. match() runs the event loop while it waits, so
/// it must not be called from a message handler, only from a posted or timed one or outside.
class RemotePool : public localization::MatchPool {
 public:
  using FaultHandler = std::function<void(std::string_view reason, std::string_view detail)>;

  /// `loop` must outlive the pool and must not run after the pool's end. Throws like Reader and
  /// Writer.
  RemotePool(const messaging::Participant& participant, messaging::EventLoop& loop,
             RemotePoolOptions options, FaultHandler on_fault);
  ~RemotePool() override;

  void add_map(std::shared_ptr<const topomap::LocalMap> map) override;
  void add_field(std::shared_ptr<const localization::PlaceField> field) override;
  /// Throws Stopped, and the exceptions of Matcher::solve for a task that cannot be solved.
  std::vector<localization::MatchResult> match(
      std::span<const localization::MatchTask> tasks) override;

  /// Waits for `count` workers, at most `patience`, and returns how many there are. Throws Stopped.
  std::size_t wait_for_workers(std::size_t count, std::chrono::nanoseconds patience);

  /// Tasks of the current batch that have no answer yet.
  [[nodiscard]] std::size_t open_tasks() const { return board_.open_tasks(); }
  [[nodiscard]] std::size_t workers() const { return board_.workers(); }
  [[nodiscard]] const search_pool::BoardCounts& counts() const { return board_.counts(); }
  [[nodiscard]] const search_pool::RegistryCounts& registry_counts() const {
    return registry_.counts();
  }
  /// Local maps sent to workers that asked for them.
  [[nodiscard]] std::uint64_t maps_sent() const { return maps_.sent(); }

 private:
  void on_status(const msg::WorkerStatus& status, const messaging::SampleInfo& info);
  void on_tick();
  void drop(const std::string& worker_id);
  void on_event(const messaging::Event& event);
  /// Readers of tasks appeared or disappeared in a process.
  void on_task_reader(const service::ParticipantId& participant);
  void on_results(const msg::MatchResults& message, const messaging::SampleInfo& info);
  void on_result(const std::string& worker_id, const msg::MatchResult& message);
  void on_answer(const std::string& worker_id, const msg::MatchResult& message);
  void on_wrong(const std::string& worker_id, std::uint64_t task_id, const std::string& what);
  /// Runs the loop until the batch is done.
  void work();
  /// Sends workers as many tasks as they can take, then ends the wait if its condition holds.
  void go_on();
  void send_waiting();
  /// Sends one message; false when the worker's history is full.
  bool send(std::span<const search_pool::TaskBoard::Assignment> of_one_worker);
  /// Solves an answered task here and blames the workers whose answers differ.
  void settle(const localization::MatchTask& task);
  void blame(const localization::MatchTask& task,
             const search_pool::TaskBoard::Difference& difference,
             const localization::MatchResult& truth);
  /// The fault of an answer; empty: none.
  std::string complaint(const localization::MatchTask& task,
                        const localization::MatchResult& result);
  localization::MatchResult solve(const localization::MatchTask& task);
  /// Gives the task's maps to the matcher.
  void prepare(const localization::MatchTask& task);
  void log_recoveries();
  /// Runs the loop until `until` holds, for `duration` at most.
  void run_loop(std::chrono::nanoseconds duration, const std::function<bool()>& until);

  messaging::EventLoop& loop_;
  RemotePoolOptions options_;
  FaultHandler on_fault_;
  const std::uint64_t matcher_fingerprint_;
  search_pool::TaskBoard board_;
  search_pool::WorkerRegistry registry_;
  search_pool::PoolLog log_;
  messaging::Reader<msg::WorkerStatus> statuses_;
  messaging::Reader<msg::MatchResults> results_;
  WorkerWriter<msg::MatchTasks> tasks_out_;
  MapSender maps_;
  localization::Matcher matcher_;  // holds the maps it has needed so far
  std::uint64_t sequence_ = 0;
  std::function<bool()> until_;
  bool woken_ = false;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::localizer
