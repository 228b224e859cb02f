// Sends messages of one type on its topic.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "topogeo/messaging/detail/endpoint.hpp"

namespace topogeo::messaging {

/// T is one of the types of topics.hpp. Include its header topogeo/msg/<file>.h to use it.
template <class T>
class Writer {
 public:
  /// `role` replaces the role of the topic, for example kReplayRole. Throws std::runtime_error when
  /// there is no such profile or the middleware refuses.
  explicit Writer(const Participant& participant, std::string_view role = {})
      : core_(std::make_shared<detail::WriterCore>(participant, TopicTraits<T>::info(),
                                                   std::string(role))) {}

  /// Sends a message. Returns false if it was not sent, because the history stayed full for the
  /// profile's max_blocking_time (a reader is slow) or has no room for another instance; send it
  /// again. Throws std::invalid_argument when the message breaks the wire contract (schema_version
  /// not set, a sequence over its bound) and std::runtime_error when the middleware fails.
  [[nodiscard]] bool write(const T& message) { return core_->write(&message); }

  /// Ends the instance with the key of `message`; other fields do not matter. Throws
  /// std::runtime_error when the middleware fails; an instance that was never written is no error.
  void dispose(const T& message) { core_->dispose(&message); }

  /// Readers that are connected now.
  [[nodiscard]] int matched() const { return core_->matched(); }
  /// Whether a reader of the same program as the reader or writer `program` is connected, for
  /// example SampleInfo::writer of one of its messages.
  [[nodiscard]] bool connected_with(const Handle& program) const {
    return core_->connected_with(program);
  }
  /// True as soon as at least `count` readers are connected, false after `timeout`.
  [[nodiscard]] bool wait_for_matched(int count, std::chrono::nanoseconds timeout) const {
    return core_->wait_for_matched(count, timeout);
  }
  /// True as soon as every connected reader has all written messages, false after `timeout`.
  [[nodiscard]] bool wait_for_acknowledgments(std::chrono::nanoseconds timeout) {
    return core_->wait_for_acknowledgments(timeout);
  }

  /// Hands over the events since the last call; for programs without an EventLoop.
  void take_events(const EventHandler& handler) { core_->take_events(handler); }

  [[nodiscard]] const std::shared_ptr<detail::WriterCore>& core() const { return core_; }

 private:
  std::shared_ptr<detail::WriterCore> core_;
};

}  // namespace topogeo::messaging
