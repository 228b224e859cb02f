// The clients of a worker.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "topogeo/search_pool/process_id.hpp"

namespace topogeo::search_pool {

/// Tracks the clients by their tasks, and which of them are connected. Has no clock. Not
/// thread-safe.
class ClientRegistry {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Client {
    std::string robot_id;
    ProcessId participant{};
    Time last_task;
    std::uint64_t answered = 0;
  };
  using Entry = std::pair<std::string, Client>;  // by client id

  /// Records a task. True if it is the first of its client.
  bool task_came(const std::string& client_id, const std::string& robot_id,
                 const ProcessId& participant, Time now);
  void answered(const std::string& client_id);

  /// A reader for results has connected or gone; a process may have several.
  void reader_came(const ProcessId& participant);
  /// Returns the clients that have gone with the last reader of their process.
  std::vector<Entry> reader_gone(const ProcessId& participant);
  /// Removes and returns the clients that are not connected and have sent no task since `before`.
  std::vector<Entry> take_silent(Time before);

  [[nodiscard]] bool is_connected(const ProcessId& participant) const {
    return readers_.contains(participant);
  }
  /// Null if the client is unknown or gone.
  [[nodiscard]] const Client* find(const std::string& client_id) const;
  /// Clients that have sent a task since `since`.
  [[nodiscard]] std::size_t active(Time since) const;
  /// Number of clients that ever sent a task.
  [[nodiscard]] std::size_t ever() const { return ever_; }

 private:
  template <class Condition>
  std::vector<Entry> take(Condition condition);

  std::map<std::string, Client> clients_;
  std::map<ProcessId, int> readers_;  // number of connected ones per process
  std::size_t ever_ = 0;
};

}  // namespace topogeo::search_pool
