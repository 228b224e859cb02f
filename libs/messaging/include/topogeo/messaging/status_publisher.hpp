// Publishes the status of a service: state, main input, counters, faults.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/input_meter.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/total_rate.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/status.h"

namespace topogeo::messaging {

struct ServiceIdentity {
  std::string service;  ///< name of the executable, up to 32 bytes
  std::string
      instance;  ///< unique among running ones, up to 64 bytes; empty: support::process_name()
  std::string robot_id;                  ///< up to 32 bytes; empty: serves every robot
  std::string version;                   ///< of the software, up to 48 bytes
  std::uint64_t config_fingerprint = 0;  ///< of the configuration; 0: it has none
};

/// Sends a ServiceStatus every half second and when the state changes. Lives in the thread of its
/// loop; must not outlive the loop.
class StatusPublisher {
 public:
  /// Throws like Writer, and std::invalid_argument when a part of the identity is too long.
  StatusPublisher(const Participant& participant, EventLoop& loop, const ServiceIdentity& identity);
  StatusPublisher(const StatusPublisher&) = delete;
  StatusPublisher& operator=(const StatusPublisher&) = delete;
  /// Sends kServiceStopped unless the state is kServiceFailed or kServiceFinished, and waits up to
  /// 200 ms for readers to have it.
  ~StatusPublisher();

  /// Sent at once. `message` is for people and may be empty; that of kServiceFailed is the last
  /// error as well. Clears set_waits_for().
  void set_state(msg::ServiceState state, std::string_view message = {});
  /// Sets kServiceWaiting for `what`: an input, a peer. Sent at once.
  void wait_for(std::string_view what);
  /// Names the thing that the service waits for in any state; empty: nothing. Sent with the next
  /// period.
  void set_waits_for(std::string_view what);
  [[nodiscard]] msg::ServiceState state() const { return status_.state(); }
  /// The state and its message, for people.
  [[nodiscard]] std::string text() const;
  /// The status as last sent, but with the current state.
  [[nodiscard]] const msg::ServiceStatus& message() const { return status_; }

  /// Names the main input before its first message has come.
  void set_input(std::string_view name);
  /// Counts a message of the main input, for example "scan". A service has one main input.
  void count_input(std::string_view name);

  /// Sent with the next period. Throws std::invalid_argument for a name over 48 bytes and
  /// std::length_error for the 65th name.
  void set_counter(const std::string& name, double value);
  void add_to_counter(const std::string& name, double amount = 1.0);

  /// Counts inputs that were dropped, by a fixed short reason (up to 48 bytes, at most 64 reasons;
  /// further ones count as "other"). Sent with the next period, like queues.
  void add_drops(std::string_view reason, std::uint64_t amount = 1);
  void set_drops(std::string_view reason, std::uint64_t total);
  /// Work that waits in the service; the traffic already reports the readers' own queues. Throws
  /// std::invalid_argument for a name over 48 bytes and std::length_error for the 17th name.
  void set_queue(const std::string& name, std::uint64_t depth, std::uint64_t capacity = 0);

  /// Counts a fault and logs it, once per second for each reason at most. `reason` is a fixed short
  /// text (up to 48 bytes, at most 32 reasons; further ones count as "other"), `detail` describes
  /// this occurrence.
  void fault(std::string_view reason, std::string_view detail);

  /// Turns events that must not be overlooked into faults: incompatible QoS, lost samples (except
  /// of a state that a newer sample has replaced), missed deadlines, invalid messages. The
  /// publisher sets itself as event handler of its loop.
  void on_event(const Event& event);

  /// Sends the status now.
  void publish();
  /// Gets each status that is sent, in the thread of the loop.
  void on_publish(std::function<void(const msg::ServiceStatus&)> handler);

 private:
  struct Fault {
    std::uint64_t count = 0;
    std::uint64_t not_logged = 0;  // since last_log
    std::chrono::steady_clock::time_point last_log;
  };
  struct Queue {
    std::uint64_t depth = 0;
    std::uint64_t capacity = 0;
  };
  using Time = std::chrono::steady_clock::time_point;

  void note_error(std::string_view text);
  std::uint64_t& drops_of(std::string_view reason);
  void fill_counts();
  void fill_traffic(Time now);

  EventLoop& loop_;
  Writer<msg::ServiceStatus> writer_;
  msg::ServiceStatus status_;
  InputMeter input_;
  std::map<std::string, double> counters_;
  std::map<std::string, Fault, std::less<>> faults_;
  std::map<std::string, std::uint64_t, std::less<>> drops_;
  std::map<std::string, Queue> queues_;
  std::map<std::pair<std::string_view, bool>, TotalRate> rates_;  // by topic and direction
  Time start_;
  Time last_error_;
  std::function<void(const msg::ServiceStatus&)> on_publish_;
  std::uint64_t timer_ = 0;
};

}  // namespace topogeo::messaging
