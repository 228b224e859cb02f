// Wires TaskRunner to topics: local maps and tasks in, results and the worker's status out.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/local_map.h"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/participant_id.hpp"
#include "topogeo/service/service.hpp"

#include "task_runner.hpp"

namespace topogeo::ga_worker {

struct WorkerOptions {
  std::uint32_t slots = 1;
  std::string worker_id;  ///< unique on the domain, no quotes; empty: "<host>-<process id>"
};

/// Lives in the loop of its service.
class GaWorkerService {
 public:
  /// Throws std::invalid_argument for 0 slots or a worker id that does not fit.
  GaWorkerService(service::Service& service, const WorkerOptions& options);

  /// Tells that it takes no more tasks, finishes those in hand and sends their results. To be
  /// called after the loop has ended; a second signal ends it at once.
  void drain();

 private:
  using Clock = std::chrono::steady_clock;
  /// Where an answer goes.
  struct Client {
    service::MatchAddress address;
    std::uint64_t task_id = 0;
    service::ParticipantId participant{};
  };
  struct Unsent {
    msg::MatchResult result;
    service::ParticipantId participant{};
    Clock::time_point since;
  };

  void on_map(const msg::LocalMap& message);
  void on_task(const msg::MatchTask& message, const messaging::SampleInfo& info);
  void on_outcome(const TaskRunner::Outcome& outcome);
  void on_event(const messaging::Event& event);
  void refuse(const Client& client, msg::MatchStatus status, const std::string& why);
  void answer(msg::MatchResult result, const Client& client);
  void send(const msg::MatchResult& result);
  void publish_status();

  service::Service& service_;
  WorkerOptions options_;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MatchResult> results_;
  messaging::Reader<msg::LocalMap> maps_;
  messaging::Reader<msg::MatchTask> tasks_;
  std::set<service::ParticipantId> connected_;  // clients whose result readers are
  std::list<Unsent> unsent_;                    // to clients whose result readers are not yet
  std::map<std::uint64_t, Client> clients_;     // by ticket
  std::uint64_t next_ticket_ = 0;
  std::uint64_t sequence_ = 0;
  msg::WorkerStatus status_;
  std::uint64_t done_ = 0;
  std::uint64_t failures_ = 0;
  Clock::time_point last_status_;
  std::chrono::nanoseconds busy_at_last_status_{0};
  std::deque<std::pair<Clock::time_point, std::uint64_t>> done_history_;
  std::optional<TaskRunner> runner_;  // last: its threads end first
};

}  // namespace topogeo::ga_worker
