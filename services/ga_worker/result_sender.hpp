// Sends the answers to tasks to their clients.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/match.h"
#include "topogeo/search_pool/client_registry.hpp"
#include "topogeo/search_pool/outboxes.hpp"
#include "topogeo/search_pool/outcome_queue.hpp"
#include "topogeo/service/service.hpp"

namespace topogeo::ga_worker {

/// The answers of a client leave when they are as many as its tasks that are still in hand: it
/// sends new ones while the worker is busy with the rest. None waits longer than 40 ms for others.
class ResultSender {
 public:
  using Clock = std::chrono::steady_clock;

  /// All that is passed by reference must outlive it. `clients` knows whom answers go to.
  /// `outcomes`, of which answers are made, learns after each change when to wake the loop.
  /// `collect` adds the answers to what waits there.
  ResultSender(service::Service& service, std::string worker_id,
               const search_pool::ClientRegistry& clients, search_pool::OutcomeQueue& outcomes,
               std::function<void()> collect);

  /// So many tasks of the client have come: an answer to each will be added.
  void expect(const std::string& client_id, std::size_t tasks);
  /// The answer to one of those tasks, whose query map has this stamp.
  void add(const std::string& client_id, msg::MatchResult result, std::int64_t stamp_ns);

  /// Sends to all clients that can be reached what waits for them.
  void send_all();
  /// Drops what a client has not taken since `before`.
  void drop_older(Clock::time_point before);
  /// The client is gone, and what was for it.
  void forget(const std::string& client_id);

  /// Answers that wait.
  [[nodiscard]] std::size_t waiting() const { return outboxes_.waiting(); }
  void wait_for_acknowledgments(std::chrono::nanoseconds patience);

 private:
  struct Answer {
    msg::MatchResult result;
    std::int64_t stamp_ns = 0;
  };

  /// A result to a client whose reader is not connected yet would be lost: it waits.
  [[nodiscard]] bool is_reachable(const std::string& client_id) const;
  /// All that waits for the client.
  void send(const std::string& client_id);
  /// The oldest answers, as many as go into a message; false when they are not sent.
  [[nodiscard]] bool send_message(const std::string& client_id);
  void send_due();
  /// To be called after each change: what is due next sets the timer and the queue.
  void schedule();

  service::Service& service_;
  std::string worker_id_;
  const search_pool::ClientRegistry& clients_;
  search_pool::OutcomeQueue& outcomes_;
  std::function<void()> collect_;
  messaging::Writer<msg::MatchResults> results_;
  search_pool::Outboxes<Answer> outboxes_;
  std::optional<std::uint64_t> timer_;
  Clock::time_point timer_due_;  // while there is a timer
  std::uint64_t messages_sent_ = 0;
};

}  // namespace topogeo::ga_worker
