// Sends the answers to tasks to their clients, several in a message where more are about to come.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/match.h"
#include "topogeo/search_pool/client_registry.hpp"
#include "topogeo/search_pool/outcome_queue.hpp"
#include "topogeo/service/service.hpp"

namespace topogeo::ga_worker {

/// The answers of a client leave when they are as many as its tasks that are still in hand: it
/// sends new ones while the worker is busy with the rest. None waits longer than 40 ms for others.
class ResultSender {
 public:
  using Clock = std::chrono::steady_clock;

  /// All that is passed by reference must outlive it: `clients` knows whom answers go to, and
  /// `outcomes`, of which answers are made, is told when to wake the loop. `collect` adds the
  /// answers to what waits there; it is called before those leave that have waited long.
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
  [[nodiscard]] std::size_t waiting() const;
  void wait_for_acknowledgments(std::chrono::nanoseconds patience);

 private:
  struct Answer {
    msg::MatchResult result;
    std::int64_t stamp_ns = 0;
    Clock::time_point since;
  };
  struct Outbox {
    std::size_t tasks_in_hand = 0;
    std::deque<Answer> answers;
  };

  /// So many more answers and those of this client leave; 0: they are to leave now.
  static std::size_t until_due(const Outbox& outbox);
  /// To be called after each change: the loop is woken when answers of a client are to leave, or
  /// begin to wait.
  void tell_when_to_wake();
  void send_old();
  /// A result to a client whose reader is not connected yet would be lost: it waits.
  [[nodiscard]] bool is_reachable(const std::string& client_id) const;
  void send(const std::string& client_id, Outbox& outbox);
  /// Sets the timer for the oldest answer.
  void wait_for_more();
  /// The oldest answers, as many as go into a message; false when they are not sent.
  [[nodiscard]] bool send_message(const std::string& client_id, Outbox& outbox);

  service::Service& service_;
  std::string worker_id_;
  const search_pool::ClientRegistry& clients_;
  search_pool::OutcomeQueue& outcomes_;
  std::function<void()> collect_;
  messaging::Writer<msg::MatchResults> results_;
  std::map<std::string, Outbox> outboxes_;  // by client id
  std::optional<std::uint64_t> timer_;
  std::uint64_t messages_sent_ = 0;
};

}  // namespace topogeo::ga_worker
