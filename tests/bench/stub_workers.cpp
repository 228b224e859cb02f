#include "stub_workers.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include <unistd.h>

#include "topogeo/matching/matcher.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/search_pool/fair_queue.hpp"
#include "topogeo/service/conversions.hpp"
#include "topogeo/service/participant_id.hpp"
#include "topogeo/support/version.hpp"

#include "pool_peers.hpp"

namespace topogeo::bench {
namespace {

/// Right answers by the seed of their task.
using Answers = std::unordered_map<std::uint64_t, localization::MatchResult>;

Answers solve_all() {
  localization::InProcessPool pool;
  TaskSource source(maps_of_floor());
  for (const auto& map : source.maps()) pool.add_map(map);
  Answers answers;
  for (localization::MatchResult& result : pool.match(source.next(kStubTasks))) {
    answers.emplace(result.seed, std::move(result));
  }
  return answers;
}

/// The clients to whose result readers all workers of this process are connected.
class Clients {
 public:
  Clients(messaging::EventLoop& loop, std::size_t workers) : workers_(workers) {
    loop.on_event([this](const messaging::Event& event) {
      if (event.topic != messaging::kMatchResults) return;
      std::size_t& readers = readers_[service::participant_of(event.peer)];
      if (event.kind == messaging::EventKind::kMatched) ++readers;
      if (event.kind == messaging::EventKind::kUnmatched && readers > 0) --readers;
    });
  }
  [[nodiscard]] bool connected(const service::ParticipantId& client) const {
    const auto found = readers_.find(client);
    return found != readers_.end() && found->second == workers_;
  }

 private:
  std::size_t workers_;
  std::map<service::ParticipantId, std::size_t> readers_;
};

class StubWorker {
 public:
  StubWorker(const messaging::Participant& participant, messaging::EventLoop& loop,
             const std::string& worker_id, const Answers& answers, const Clients& clients,
             std::chrono::microseconds cost)
      : answers_(answers),
        clients_(clients),
        loop_(loop),
        cost_(cost),
        statuses_(participant),
        results_(participant),
        tasks_(participant, {.role = {}, .addressee = worker_id}) {
    loop.add(results_);
    loop.add<msg::MatchTasks>(
        tasks_, [this](const msg::MatchTasks& tasks, const messaging::SampleInfo& info) {
          take({tasks, service::participant_of(info.writer)});
        });
    loop.on_event([this](const messaging::Event&) {
      std::erase_if(unsent_, [this](const Asked& asked) { return answered(asked); });
    });
    messaging::set_header(status_, "", 0, 0);
    messaging::set_worker_id(status_, worker_id);
    messaging::set_text(status_.name(), "stub", "name");
    messaging::set_text(status_.version(), support::kVersion, "version");
    status_.process_id(static_cast<std::uint32_t>(::getpid()));
    status_.slots(1);
    status_.matcher_fingerprint(localization::matcher_fingerprint());
    constexpr std::chrono::milliseconds kStatusPeriod{500};  // that of a ga_worker
    loop.add_timer(kStatusPeriod, [this] { announce(); });
    announce();
  }
  StubWorker(const StubWorker&) = delete;
  StubWorker& operator=(const StubWorker&) = delete;

 private:
  void announce() {
    status_.tasks_done(done_);
    if (!statuses_.write(status_)) std::cerr << "status not sent\n";
  }

  struct Asked {
    msg::MatchTasks tasks;
    service::ParticipantId client;
  };

  // Takes one task after the other, clients in turn, like a ga_worker of one slot. Without a cost,
  // one message answers all tasks of a message.
  void take(const Asked& asked) {
    if (cost_.count() == 0) {
      answer(asked);
      return;
    }
    for (const msg::MatchTask& task : asked.tasks.tasks()) {
      Asked one = asked;
      one.tasks.tasks().assign(1, task);
      queue_.push(asked.tasks.client_id().to_string(), one);
    }
    if (!busy_) begin();
  }

  void begin() {
    busy_ = !queue_.empty();
    if (!busy_) return;
    loop_.call_after(cost_, [this, asked = *queue_.pop()] {
      answer(asked);
      begin();
    });
  }

  // Keeps an answer whose client is not connected yet, like a ga_worker: it would be lost.
  void answer(const Asked& asked) {
    if (!answered(asked)) unsent_.push_back(asked);
  }

  bool answered(const Asked& asked) {
    if (!clients_.connected(asked.client)) return false;
    service::MatchAddress address;
    address.robot_id = asked.tasks.robot_id().to_string();
    address.stamp_ns = asked.tasks.stamp_ns();
    address.sequence_number = sequence_++;
    address.worker_id = asked.tasks.worker_id().to_string();
    address.client_id = asked.tasks.client_id().to_string();
    msg::MatchResults message = service::results_for(address);
    for (const msg::MatchTask& wanted : asked.tasks.tasks()) {
      const localization::MatchTask task = service::from_msg(wanted);
      localization::MatchResult result = answers_.at(task.seed);
      result.task_id = task.task_id;
      message.results().push_back(service::to_msg(result));
      ++done_;
    }
    if (!results_.write(message)) std::cerr << "results not sent\n";
    return true;
  }

  const Answers& answers_;
  const Clients& clients_;
  messaging::EventLoop& loop_;
  std::chrono::microseconds cost_;
  search_pool::FairQueue<Asked> queue_;
  std::vector<Asked> unsent_;
  bool busy_ = false;
  std::uint64_t done_ = 0;
  std::uint64_t sequence_ = 0;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MatchResults> results_;
  messaging::Reader<msg::MatchTasks> tasks_;
  msg::WorkerStatus status_;
};

std::string value_of(std::span<char*> words, const std::string& flag) {
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    if (words[i] == flag) return words[i + 1];
  }
  throw std::invalid_argument("stub workers: " + flag + " is missing");
}

}  // namespace

int run_stub_workers(int argc, char** argv) {
  try {
    const std::span<char*> words(argv, static_cast<std::size_t>(argc));
    messaging::ParticipantOptions options;
    options.domain = static_cast<std::uint32_t>(std::stoul(value_of(words, "--domain")));
    options.partition = value_of(words, "--partition");
    options.name = "stub workers";
    const Answers answers = solve_all();
    messaging::EventLoop loop;
    const messaging::SignalStop signals([&](int) { loop.stop(); });
    options.identity = "ga_worker";
    const messaging::Participant participant(options);
    std::vector<std::unique_ptr<StubWorker>> workers;
    const std::size_t count = std::stoul(value_of(words, "--stub-workers"));
    const std::chrono::microseconds cost{std::stol(value_of(words, "--cost-us"))};
    const Clients clients(loop, count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::string worker_id = "stub#" + std::to_string(::getpid()) + "-" + std::to_string(i);
      workers.push_back(
          std::make_unique<StubWorker>(participant, loop, worker_id, answers, clients, cost));
    }
    loop.run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}

}  // namespace topogeo::bench
