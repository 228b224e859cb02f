// The service around the slots: takes maps and tasks; publishes results, map requests and the
// worker's status.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/search_pool/client_registry.hpp"
#include "topogeo/search_pool/drain_watch.hpp"
#include "topogeo/search_pool/outcome_queue.hpp"
#include "topogeo/search_pool/task_intake.hpp"
#include "topogeo/search_pool/task_runner.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/participant_id.hpp"
#include "topogeo/service/service.hpp"
#include "topogeo/support/patience.hpp"

#include "result_sender.hpp"

namespace topogeo::ga_worker {

struct WorkerOptions {
  std::uint32_t slots = 1;
  std::uint32_t memory_mb = 64;  ///< for local maps and their features
  search_pool::SlotScheduling scheduling = search_pool::SlotScheduling::kBatch;
  std::string name;       ///< see check_name
  std::string worker_id;  ///< see make_worker_id
};

/// Lives in the loop of its service.
class GaWorkerService {
 public:
  /// Throws std::invalid_argument for 0 slots or texts that do not fit their bounds.
  GaWorkerService(service::Service& service, const WorkerOptions& options);

  /// Publishes that it takes no more tasks, finishes those in hand and sends their results. Call it
  /// after the loop has ended; a second signal stops it at once.
  void drain();

 private:
  using Clock = std::chrono::steady_clock;
  /// A task in hand, with the destination of its answer.
  struct Asked {
    std::string client_id;
    std::int64_t stamp_ns = 0;
    std::uint64_t task_id = 0;
  };

  void fill_status();
  void listen();

  void on_tasks(const msg::MatchTasks& message, const messaging::SampleInfo& info);
  /// Gives the task to the runner, or queues it until its maps arrive.
  void take(const msg::MatchTask& message, const Asked& asked, const std::string& robot_id);
  /// Answers the tasks that the slots have finished.
  void take_outcomes();
  void on_outcome(const search_pool::TaskRunner::Outcome& outcome);
  void on_event(const messaging::Event& event);

  /// Why this worker must refuse the tasks; nothing when it can take them.
  [[nodiscard]] std::optional<std::pair<msg::MatchStatus, std::string>> objection(
      const msg::MatchTasks& message) const;
  void run(std::vector<search_pool::ReadyJob> jobs);
  /// Requests the missing maps, gives up tasks that have waited too long, and sets a timer for the
  /// next check.
  void request_missing_maps();
  void request(const search_pool::TaskIntake::Request& request);
  void refuse(const Asked& asked, msg::MatchStatus status, const std::string& why);
  void answer(const Asked& asked, msg::MatchResult result);
  void forget(const std::vector<search_pool::ClientRegistry::Entry>& gone);
  /// Forgets clients that have not connected, and answers that a client has not taken.
  void drop_overdue(Clock::time_point time);
  void publish_status();
  void measure_load(Clock::time_point time);

  service::Service& service_;
  WorkerOptions options_;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MapRequest> requests_;
  search_pool::ClientRegistry clients_;
  search_pool::OutcomeQueue outcomes_;
  ResultSender results_;
  search_pool::TaskIntake intake_;
  std::optional<std::uint64_t> request_timer_;
  std::map<std::uint64_t, Asked> asked_;  // by ticket
  std::uint64_t next_ticket_ = 0;
  std::uint64_t maps_requested_ = 0;
  msg::WorkerStatus status_;
  std::uint64_t done_ = 0;
  std::uint64_t failures_ = 0;
  Clock::time_point start_ = Clock::now();
  support::PatienceWindow client_patience_;  // in seconds from the start
  Clock::time_point last_status_ = start_;
  std::chrono::nanoseconds busy_at_last_status_{0};
  std::deque<std::pair<Clock::time_point, std::uint64_t>> done_history_;
  std::optional<search_pool::TaskRunner> runner_;  // last: its threads end first
};

}  // namespace topogeo::ga_worker
