// Writes messages that are addressed to workers: the worker's id is the key of the topic.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>

#include "topogeo/messaging/events.hpp"
#include "topogeo/messaging/message.hpp"
#include "topogeo/messaging/participant.hpp"
#include "topogeo/messaging/topics.hpp"
#include "topogeo/messaging/writer.hpp"
#include "topogeo/service/participant_id.hpp"

namespace topogeo::localizer {

/// Tracks which processes are connected, because a message to a worker without a connected reader
/// would be lost. Forgets the ids of a process that is gone, because a writer has room for a
/// bounded number of them and every starting worker has a new one.
template <class T>
class WorkerWriter {
 public:
  explicit WorkerWriter(const messaging::Participant& participant) : writer_(participant) {}

  /// Add it to the loop whose events are passed to follow().
  [[nodiscard]] const messaging::Writer<T>& writer() const { return writer_; }

  /// Whether a reader of the process is connected.
  [[nodiscard]] bool connected(const service::ParticipantId& process) const {
    return readers_.contains(process);
  }

  /// Sends to a worker of that process; returns and throws like Writer::write.
  [[nodiscard]] bool write(const T& message, const service::ParticipantId& process) {
    addressed_[process].insert(message.worker_id().to_string());
    return writer_.write(message);
  }

  /// The process in which a reader of this writer appeared or disappeared; nothing for other
  /// events.
  std::optional<service::ParticipantId> follow(const messaging::Event& event) {
    if (event.topic != messaging::TopicTraits<T>::info().name) return {};
    const service::ParticipantId process = service::participant_of(event.peer);
    if (event.kind == messaging::EventKind::kMatched) {
      readers_.insert(process);
    } else if (event.kind == messaging::EventKind::kUnmatched) {
      const auto found = readers_.find(process);
      if (found != readers_.end()) readers_.erase(found);
      if (!connected(process)) forget(process);
    } else {
      return {};
    }
    return process;
  }

 private:
  void forget(const service::ParticipantId& process) {
    const auto found = addressed_.find(process);
    if (found == addressed_.end()) return;
    for (const std::string& worker_id : found->second) {
      T message;
      messaging::set_worker_id(message, worker_id);
      writer_.dispose(message);
    }
    addressed_.erase(found);
  }

  messaging::Writer<T> writer_;
  std::multiset<service::ParticipantId> readers_;                      // a process may have several
  std::map<service::ParticipantId, std::set<std::string>> addressed_;  // worker ids
};

}  // namespace topogeo::localizer
