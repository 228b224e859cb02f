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

/// Sends the answers of a client once they are as many as its tasks still in hand, so that the
/// client sends new tasks while the worker is busy with the rest. No answer waits longer than 40
/// ms.
class ResultSender {
 public:
  using Clock = std::chrono::steady_clock;

  /// All references must outlive this object. `clients` gives the recipients of the answers.
  /// `outcomes`, the source of the answers, is set after each change to wake the loop in time.
  /// `collect` adds the finished answers from there.
  ResultSender(service::Service& service, std::string worker_id,
               const search_pool::ClientRegistry& clients, search_pool::OutcomeQueue& outcomes,
               std::function<void()> collect);

  /// Announces `tasks` tasks of the client: an answer to each will be added.
  void expect(const std::string& client_id, std::size_t tasks);
  /// Adds the answer to one of those tasks; `stamp_ns` is the stamp of its query map.
  void add(const std::string& client_id, msg::MatchResult result, std::int64_t stamp_ns);

  /// Sends the waiting answers of all clients that can be reached.
  void send_all();
  /// Drops answers that a client has not taken since `before`.
  void drop_older(Clock::time_point before);
  /// Drops a client that is gone, with its answers.
  void forget(const std::string& client_id);

  /// Number of waiting answers.
  [[nodiscard]] std::size_t waiting() const { return outboxes_.waiting(); }
  void wait_for_acknowledgments(std::chrono::nanoseconds patience);

 private:
  struct Answer {
    msg::MatchResult result;
    std::int64_t stamp_ns = 0;
  };

  /// False while the client's reader is not connected: a result would be lost, so it waits.
  [[nodiscard]] bool is_reachable(const std::string& client_id) const;
  /// Sends all that waits for the client.
  void send(const std::string& client_id);
  /// Sends the oldest answers, as many as fit into a message; false when they are not sent.
  [[nodiscard]] bool send_message(const std::string& client_id);
  void send_due();
  /// Call it after each change: the next due time sets the timer and the queue.
  void schedule();

  service::Service& service_;
  std::string worker_id_;
  const search_pool::ClientRegistry& clients_;
  search_pool::OutcomeQueue& outcomes_;
  std::function<void()> collect_;
  messaging::Writer<msg::MatchResults> results_;
  search_pool::Outboxes<Answer> outboxes_;
  std::optional<std::uint64_t> timer_;
  Clock::time_point timer_due_;  // valid while there is a timer
  std::uint64_t messages_sent_ = 0;
};

}  // namespace topogeo::ga_worker
