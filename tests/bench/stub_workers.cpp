#include "stub_workers.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include <unistd.h>

#include "topogeo/localization/matching/matcher.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/reader.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/msg/match.h"
#include "topogeo/msg/status.h"
#include "topogeo/search_pool/fair_queue.hpp"
#include "topogeo/service/conversions.hpp"
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

class StubWorker {
 public:
  StubWorker(const messaging::Participant& participant, messaging::EventLoop& loop,
             const std::string& worker_id, const Answers& answers, std::chrono::microseconds cost)
      : answers_(answers),
        loop_(loop),
        cost_(cost),
        statuses_(participant),
        results_(participant),
        tasks_(participant, {.role = {}, .addressee = worker_id}) {
    loop.add<msg::MatchTask>(
        tasks_, [this](const msg::MatchTask& task, const messaging::SampleInfo&) { take(task); });
    messaging::set_header(status_, "", 0, 0);
    messaging::set_worker_id(status_, worker_id);
    messaging::set_text(status_.name(), "stub", "name");
    messaging::set_text(status_.version(), support::kVersion, "version");
    status_.process_id(static_cast<std::uint32_t>(::getpid()));
    status_.slots(1);
    status_.matcher_fingerprint(localization::matcher_fingerprint());
    constexpr std::chrono::milliseconds kStatusPeriod{500};  // as a ga_worker
    loop.add_timer(kStatusPeriod, [this] { announce(); });
    announce();
  }
  StubWorker(const StubWorker&) = delete;
  StubWorker& operator=(const StubWorker&) = delete;

 private:
  void announce() {
    status_.tasks_done(sent_);
    if (!statuses_.write(status_)) std::cerr << "status not sent\n";
  }

  // One task after the other, clients in turn, as in a ga_worker of one slot.
  void take(const msg::MatchTask& task) {
    if (cost_.count() == 0) {
      answer(task);
      return;
    }
    queue_.push(task.client_id().to_string(), task);
    if (!busy_) begin();
  }

  void begin() {
    busy_ = !queue_.empty();
    if (!busy_) return;
    loop_.call_after(cost_, [this, task = *queue_.pop()] {
      answer(task);
      begin();
    });
  }

  void answer(const msg::MatchTask& message) {
    const localization::MatchTask task = service::from_msg(message);
    localization::MatchResult result = answers_.at(task.seed);
    result.task_id = task.task_id;
    service::MatchAddress address;
    address.robot_id = message.robot_id().to_string();
    address.stamp_ns = message.stamp_ns();
    address.sequence_number = sent_++;
    address.worker_id = message.worker_id().to_string();
    address.client_id = message.client_id().to_string();
    if (!results_.write(service::to_msg(result, address))) std::cerr << "result not sent\n";
  }

  const Answers& answers_;
  messaging::EventLoop& loop_;
  std::chrono::microseconds cost_;
  search_pool::FairQueue<msg::MatchTask> queue_;
  bool busy_ = false;
  std::uint64_t sent_ = 0;
  messaging::Writer<msg::WorkerStatus> statuses_;
  messaging::Writer<msg::MatchResult> results_;
  messaging::Reader<msg::MatchTask> tasks_;
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
    const messaging::Participant participant(options);
    std::vector<std::unique_ptr<StubWorker>> workers;
    const std::size_t count = std::stoul(value_of(words, "--stub-workers"));
    const std::chrono::microseconds cost{std::stol(value_of(words, "--cost-us"))};
    for (std::size_t i = 0; i < count; ++i) {
      const std::string worker_id = "stub#" + std::to_string(::getpid()) + "-" + std::to_string(i);
      workers.push_back(std::make_unique<StubWorker>(participant, loop, worker_id, answers, cost));
    }
    loop.run();
    return 0;
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}

}  // namespace topogeo::bench
