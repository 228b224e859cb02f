// A running service: its participant, event loop, status and the signals that end it.
#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "topogeo/messaging/event_loop.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/signal_stop.hpp"
#include "topogeo/messaging/status_publisher.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/service/service_options.hpp"

namespace topogeo::service {

/// One at a time in a process. Readers and writers of a service are made with participant(), added
/// to loop(), and live at least as long as run().
class Service {
 public:
  /// Joins the domain and tells that the service starts. `any_robot`: it serves every robot and
  /// its status names none. Throws like messaging::Participant and StatusPublisher.
  explicit Service(const Setup& setup, bool any_robot = false);
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;
  ~Service();

  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] const std::string& robot_id() const { return setup_.options.robot_id; }
  [[nodiscard]] const messaging::Participant& participant() const { return participant_; }
  [[nodiscard]] messaging::EventLoop& loop() { return loop_; }
  [[nodiscard]] messaging::StatusPublisher& status() { return *status_; }

  /// True when a signal has asked the program to end.
  [[nodiscard]] static bool stopping() { return messaging::SignalStop::received() != 0; }

  /// Works until SIGINT, SIGTERM or loop().stop(). An exception of a handler makes the state
  /// kServiceFailed with its text and comes out here.
  void run();

  /// Sends, again and again while the history is full, counted as fault "send blocked". False when
  /// the program is asked to end before it could be sent. Throws like Writer::write.
  template <class T>
  bool send(messaging::Writer<T>& writer, const T& message, std::string_view what) {
    while (!writer.write(message)) {
      if (stopping()) return false;
      tell_blocked(what);
    }
    return true;
  }

  /// False, and counted as "ignored: other robot", for messages of other robots.
  template <class T>
  bool is_own(const T& message) {
    if (message.robot_id() == setup_.options.robot_id) return true;
    status_->add_to_counter("ignored: other robot");
    return false;
  }

  /// Calls `use` for a message of this robot; std::invalid_argument from it becomes the fault
  /// "invalid <what>".
  template <class T, class Use>
  void take(const T& message, const char* what, const Use& use) {
    if (!is_own(message)) return;
    try {
      use(message);
    } catch (const std::invalid_argument& error) {
      status_->fault(std::string("invalid ") + what, error.what());
    }
  }

 private:
  void tell_blocked(std::string_view what);

  Setup setup_;
  messaging::Participant participant_;
  messaging::EventLoop loop_;
  std::optional<messaging::StatusPublisher> status_;
  std::optional<messaging::SignalStop> signals_;
};

}  // namespace topogeo::service
