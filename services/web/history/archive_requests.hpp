// Requests to the map store for its snapshots, and its replies.
#pragma once

#include <cstdint>
#include <string>

#include "topogeo/messaging/writer.hpp"
#include "topogeo/msg/archive.h"
#include "topogeo/service/service.hpp"

#include "orders/pending_requests.hpp"
#include "server/web_types.hpp"

namespace topogeo::web {

/// Lives in the loop of its service. Each function answers once: 200 with the snapshots by time,
/// 409 where the map store refuses, 503 where none replies in time.
class ArchiveRequests {
 public:
  explicit ArchiveRequests(service::Service& service);

  void list(Respond respond);
  /// Both throw std::invalid_argument for a name that no snapshot can have.
  void take(const std::string& name, Respond respond);
  void restore(const std::string& name, Respond respond);

 private:
  void send(msg::ArchiveAction action, const std::string& name, Respond respond);
  void on_reply(const msg::ArchiveReply& reply);

  service::Service& service_;
  std::string client_id_;
  std::uint64_t sent_ = 0;
  PendingRequests pending_;
  messaging::Writer<msg::ArchiveRequest> requests_;
};

}  // namespace topogeo::web
