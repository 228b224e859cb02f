// Receives messages of one type from its topic.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "topogeo/messaging/detail/endpoint.hpp"

namespace topogeo::messaging {

struct ReaderOptions {
  std::string role = {};  ///< replaces the role of the topic, for example kReplayRole
  /// Receives only the messages to this addressee, which the writer selects; empty: every message.
  /// A reader with an addressee gets no disposals.
  std::string addressee = {};
  /// Whole names of other topics whose messages this program needs from the same moment on: a
  /// writer that waits for its readers also waits until the program is connected to these
  /// (ConnectedPrograms). The program makes a reader of each.
  std::vector<std::string_view> read_with = {};
};

/// T is one of the types of topics.hpp. Include its header topogeo/msg/<file>.h to use it.
template <class T>
class Reader {
 public:
  using Handler = std::function<void(const T& message, const SampleInfo& info)>;

  /// Throws std::runtime_error when there is no such profile, the messages of the topic have no
  /// addressee or the middleware refuses.
  explicit Reader(const Participant& participant, const ReaderOptions& options = {})
      : core_(std::make_shared<detail::ReaderCore>(participant, TopicTraits<T>::info(),
                                                   options.role, options.addressee,
                                                   options.read_with)) {}

  /// Hands over at most `limit` samples, oldest first of each writer, and returns how many. If
  /// info.valid is false, the message is empty: only info.instance and info.state count. A handler
  /// that throws std::invalid_argument refuses the message, which gives the event kInvalidSample.
  std::size_t take(const Handler& handler,
                   std::size_t limit = std::numeric_limits<std::size_t>::max()) {
    return core_->take(limit, [&](const void* message, const SampleInfo& info) {
      handler(*static_cast<const T*>(message), info);
    });
  }

  /// True as soon as there is something to take, false after `timeout`. An EventLoop does this for
  /// many readers at once.
  [[nodiscard]] bool wait_for_data(std::chrono::nanoseconds timeout) {
    return core_->wait_for_data(timeout);
  }

  /// Writers that are connected now.
  [[nodiscard]] int matched() const { return core_->matched(); }
  /// Whether a writer of the same program as the reader or writer `program` is connected.
  [[nodiscard]] bool connected_with(const Handle& program) const {
    return core_->connected_with(program);
  }
  /// True as soon as at least `count` writers are connected, false after `timeout`.
  [[nodiscard]] bool wait_for_matched(int count, std::chrono::nanoseconds timeout) const {
    return core_->wait_for_matched(count, timeout);
  }
  /// Hands over the events since the last call; for programs without an EventLoop.
  void take_events(const EventHandler& handler) { core_->take_events(handler); }

  [[nodiscard]] const std::shared_ptr<detail::ReaderCore>& core() const { return core_; }

 private:
  std::shared_ptr<detail::ReaderCore> core_;
};

}  // namespace topogeo::messaging
